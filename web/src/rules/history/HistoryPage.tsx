import { Button, Select } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { useAsked } from "../../api/queries";
import { diffRules, getHistory } from "../../api/rulesClient";
import type { History, Revision } from "../../api/ruleTypes";
import { Problem } from "../../ui/Problem";
import page from "../../ui/page.module.css";
import { useRules } from "../context/RulesContext";
import { DiffList } from "../parts/DiffList";
import classes from "./History.module.css";
import { RevisionRow } from "./RevisionRow";

const PAGE = 25;

/** Every table that was ever in force: who, when, why, and the way back. */
export function HistoryPage({ revision }: { revision: number | null }) {
  const { view } = useRules();
  const client = useQueryClient();
  const key = ["history", view?.revision, view?.confirmed];
  const { data: history, error } = useAsked({
    key,
    ask: (signal) => getHistory(null, PAGE, signal),
    keep: true,
  });
  const oldest = history?.revisions.at(-1)?.number;
  const older = useMutation({
    mutationFn: (before: number) => getHistory(before, PAGE),
    onSuccess: (next) =>
      client.setQueryData<History>(
        key,
        (was) => was && { ...next, revisions: [...was.revisions, ...next.revisions] },
      ),
  });

  return (
    <div className={page.page} data-testid="history">
      <Problem error={error ?? older.error} />
      {history === null && error === null && <p className={page.muted}>Reading the history…</p>}
      {history !== null && (
        <>
          <Compare revisions={history.revisions} />
          <ul className={classes.list}>
            {history.revisions.map((each, index) => (
              <RevisionRow
                key={each.number}
                revision={each}
                newer={history.revisions[index - 1]?.time ?? null}
                active={history.active}
                startOpen={each.number === revision}
              />
            ))}
          </ul>
          {history.more && oldest !== undefined && (
            <Button variant="default" onClick={() => older.mutate(oldest)}>
              Older
            </Button>
          )}
        </>
      )}
    </div>
  );
}

/** The difference between any two revisions. */
function Compare({ revisions }: { revisions: Revision[] }) {
  const [from, setFrom] = useState<string | null>(null);
  const [to, setTo] = useState<string | null>(null);
  const { data: diff, error } = useAsked({
    key: ["diff", from, to],
    enabled: from !== null && to !== null,
    ask: (signal) => diffRules(Number(from), Number(to), signal),
  });
  const data = revisions.map(({ number, author }) => ({
    value: String(number),
    label: `rev ${number}, ${author}`,
  }));
  return (
    <section className={page.section} aria-label="Compare two revisions">
      <h3>Compare two revisions</h3>
      <div className={page.pair}>
        <Select
          size="sm"
          aria-label="From revision"
          placeholder="from revision"
          data={data}
          value={from}
          onChange={setFrom}
          clearable
        />
        <Select
          size="sm"
          aria-label="To revision"
          placeholder="to revision"
          data={data}
          value={to}
          onChange={setTo}
          clearable
        />
      </div>
      <Problem error={error} />
      {diff !== null && <DiffList changes={diff.changes} />}
    </section>
  );
}
