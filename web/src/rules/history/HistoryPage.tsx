import { Button, Select } from "@mantine/core";
import { useCallback, useEffect, useState } from "react";
import { type ApiError, asApiError } from "../../api/errors";
import { diffRules, getHistory } from "../../api/rulesClient";
import type { History, Revision, TableDiff } from "../../api/ruleTypes";
import page from "../../ui/page.module.css";
import { useRules } from "../context/RulesContext";
import { DiffList } from "../parts/DiffList";
import classes from "./History.module.css";
import { RevisionRow } from "./RevisionRow";

const PAGE = 25;

/** Every table that was ever in force: who, when, why, and the way back. */
export function HistoryPage({ revision }: { revision: number | null }) {
  const { view } = useRules();
  const [history, setHistory] = useState<History | null>(null);
  const [error, setError] = useState<ApiError | null>(null);
  const active = view?.revision;
  const confirmed = view?.confirmed;

  // biome-ignore lint/correctness/useExhaustiveDependencies: another revision is another history
  useEffect(() => {
    let left = false;
    getHistory(null, PAGE).then(
      (answer) => {
        if (left) return;
        setHistory(answer);
        setError(null);
      },
      (failure: unknown) => {
        if (!left) setError(asApiError(failure));
      },
    );
    return () => {
      left = true;
    };
  }, [active, confirmed]);

  const more = useCallback(() => {
    const oldest = history?.revisions.at(-1)?.number;
    if (history === null || oldest === undefined) return;
    getHistory(oldest, PAGE).then(
      (older) => setHistory({ ...older, revisions: [...history.revisions, ...older.revisions] }),
      (failure: unknown) => setError(asApiError(failure)),
    );
  }, [history]);

  return (
    <div className={page.page} data-testid="history">
      {error !== null && (
        <p className={page.problem}>
          {error.title} {error.remedy}
        </p>
      )}
      {history === null && error === null && <p className={page.muted}>Reading the history…</p>}
      {history !== null && (
        <>
          <Compare revisions={history.revisions} />
          <ul className={classes.list}>
            {history.revisions.map((each) => (
              <RevisionRow
                key={each.number}
                revision={each}
                active={history.active}
                startOpen={each.number === revision}
              />
            ))}
          </ul>
          {history.more && (
            <Button variant="default" onClick={more}>
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
  const [diff, setDiff] = useState<TableDiff | null>(null);
  const [error, setError] = useState<ApiError | null>(null);
  useEffect(() => {
    setDiff(null);
    setError(null);
    if (from === null || to === null) return;
    let left = false;
    diffRules(Number(from), Number(to)).then(
      (answer) => {
        if (!left) setDiff(answer);
      },
      (failure: unknown) => {
        if (!left) setError(asApiError(failure));
      },
    );
    return () => {
      left = true;
    };
  }, [from, to]);
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
      {error !== null && (
        <p className={page.problem}>
          {error.title} {error.remedy}
        </p>
      )}
      {diff !== null && <DiffList changes={diff.changes} />}
    </section>
  );
}
