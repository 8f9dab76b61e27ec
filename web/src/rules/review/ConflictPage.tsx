import { Button } from "@mantine/core";
import { useMemo, useState } from "react";
import { useAsked } from "../../api/queries";
import { getHistory } from "../../api/rulesClient";
import { useNow } from "../../state/RobotContext";
import page from "../../ui/page.module.css";
import { type Choice, defaultSide, differences, isMade, rebase } from "../changes/conflict";
import { beginDraft } from "../changes/draft";
import { useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import { whenText } from "../model/words";
import { ConflictChoice } from "./ConflictChoice";

/** Somebody else was faster: both changes side by side, and a choice for each rule. */
export function ConflictPage() {
  const { view, draft } = useRules();
  const nav = useNav();
  const mine = draft.draft;
  const [sides, setSides] = useState<Record<string, Choice>>({});
  const found = useMemo(
    () =>
      mine === null || view === null ? [] : differences(mine.baseTable, view.table, mine.table),
    [mine, view],
  );
  if (mine === null || view === null || !draft.overtaken) {
    return (
      <div className={page.page}>
        <p className={page.muted}>There is nothing to merge.</p>
        <Button variant="default" onClick={() => nav.go({ at: "table" })}>
          To the rules
        </Button>
      </div>
    );
  }
  if (found.length === 0) {
    return (
      <div className={page.page} data-testid="conflict">
        <p className={page.muted}>
          What you changed is in force already: revision {view.revision} says the same.
        </p>
        <Button
          onClick={() => {
            draft.discardAll();
            nav.go({ at: "table" });
          }}
          data-testid="conflict-same"
        >
          To the rules
        </Button>
      </div>
    );
  }
  const merge = () => {
    draft.take({
      ...beginDraft(view.robot, view.revision, view.table),
      table: rebase(mine.baseTable, view.table, mine.table, sides),
      reason: mine.reason,
    });
    nav.go({ at: "review" });
  };
  const both = found.filter((each) => each.both);
  const open = both.filter((each) => !isMade(each, sides[each.id]));
  const others = found.filter((each) => !each.both);
  return (
    <div className={page.page} data-testid="conflict">
      <div className={page.title}>
        <h2>Somebody else was faster</h2>
      </div>
      <p className={page.note}>
        Nothing of yours was applied, and nothing is lost. Your changes began from revision{" "}
        {mine.base}; <Who revision={view.revision} /> Choose for each rule that both of you changed.
      </p>
      {both.map((each) => (
        <ConflictChoice
          key={each.id}
          difference={each}
          choice={sides[each.id] ?? null}
          tables={{ mine: mine.table, theirs: view.table }}
          onChoose={(choice) => setSides({ ...sides, [each.id]: choice })}
        />
      ))}
      {others.length > 0 && (
        <section className={page.section} aria-label="Changed by one of you">
          <h3>Changed by one of you only</h3>
          {others.map((each) => (
            <ConflictChoice
              key={each.id}
              difference={each}
              choice={sides[each.id] ?? defaultSide(each)}
              tables={{ mine: mine.table, theirs: view.table }}
              onChoose={(choice) => setSides({ ...sides, [each.id]: choice })}
            />
          ))}
        </section>
      )}
      <div className={page.line}>
        <Button disabled={open.length > 0} onClick={merge} data-testid="conflict-merge">
          {open.length > 0
            ? `Choose for ${open.length === 1 ? "one more rule" : `${open.length} more rules`}`
            : `Go on from revision ${view.revision}`}
        </Button>
      </div>
    </div>
  );
}

function Who({ revision }: { revision: number }) {
  const now = useNow();
  const { data } = useAsked({
    key: ["author of revision", revision],
    ask: (signal) => getHistory(null, 10, signal),
  });
  const found = data?.revisions.find(({ number }) => number === revision) ?? null;
  // The sentence does without the name where it cannot be had.
  return found === null ? (
    <>revision {revision} is in force now.</>
  ) : (
    <>
      revision {revision} by <strong>{found.author}</strong> is in force,{" "}
      {whenText(found.time, now)}
      {found.reason !== "" && ` ("${found.reason}")`}.
    </>
  );
}
