import { Button } from "@mantine/core";
import { useEffect, useMemo, useState } from "react";
import { getHistory } from "../../api/rulesClient";
import type { Revision, RuleChange } from "../../api/ruleTypes";
import { useRules } from "../live/RulesContext";
import { useNav } from "../live/RulesNav";
import { useNow } from "../live/useNow";
import { type Difference, defaultSide, differences, rebase, type Side } from "../model/conflict";
import { beginDraft } from "../model/draft";
import { whenText } from "../model/words";
import sheet from "../Sheet.module.css";
import classes from "./Review.module.css";

/** Somebody else was faster: both changes side by side, and a choice for each rule. */
export function ConflictPage() {
  const { view, draft } = useRules();
  const nav = useNav();
  const mine = draft.draft;
  const [sides, setSides] = useState<Record<string, Side>>({});
  const found = useMemo(
    () =>
      mine === null || view === null ? [] : differences(mine.baseTable, view.table, mine.table),
    [mine, view],
  );
  if (mine === null || view === null || !draft.overtaken) {
    return (
      <div className={sheet.page}>
        <p className={sheet.muted}>There is nothing to merge.</p>
        <Button variant="default" onClick={() => nav.go({ at: "table" })}>
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
  const open = both.filter((each) => sides[each.id] === undefined);
  const others = found.filter((each) => !each.both);
  return (
    <div className={sheet.page} data-testid="conflict">
      <div className={sheet.title}>
        <h2>Somebody else was faster</h2>
      </div>
      <p className={sheet.note}>
        Nothing of yours was applied, and nothing is lost. Your changes began from revision{" "}
        {mine.base}; <Who revision={view.revision} /> Choose for each rule that both of you changed.
      </p>
      {both.map((each) => (
        <Choice
          key={each.id}
          difference={each}
          side={sides[each.id] ?? null}
          onChoose={(side) => setSides({ ...sides, [each.id]: side })}
        />
      ))}
      {others.length > 0 && (
        <section className={sheet.section} aria-label="Changed by one of you">
          <h3>Changed by one of you only</h3>
          {others.map((each) => (
            <Choice
              key={each.id}
              difference={each}
              side={sides[each.id] ?? defaultSide(each)}
              onChoose={(side) => setSides({ ...sides, [each.id]: side })}
            />
          ))}
        </section>
      )}
      <div className={sheet.line}>
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
  const [found, setFound] = useState<Revision | null>(null);
  const now = useNow();
  useEffect(() => {
    let left = false;
    getHistory(null, 10).then(
      (history) => {
        if (!left) setFound(history.revisions.find(({ number }) => number === revision) ?? null);
      },
      () => setFound(null), // the sentence does without the name
    );
    return () => {
      left = true;
    };
  }, [revision]);
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

interface ChoiceProps {
  difference: Difference;
  side: Side | null;
  onChoose: (side: Side) => void;
}

function Choice({ difference, side, onChoose }: ChoiceProps) {
  return (
    <div className={classes.conflict} data-testid={`conflict-${difference.id}`}>
      <strong>{difference.name}</strong>
      <div className={classes.sides} role="radiogroup" aria-label={difference.name}>
        <SideButton
          label="Mine"
          change={difference.mine}
          on={side === "mine"}
          onClick={() => onChoose("mine")}
        />
        <SideButton
          label="Theirs"
          change={difference.theirs}
          on={side === "theirs"}
          onClick={() => onChoose("theirs")}
        />
      </div>
    </div>
  );
}

function SideButton(props: {
  label: "Mine" | "Theirs";
  change: RuleChange | null;
  on: boolean;
  onClick: () => void;
}) {
  const { label, change, on, onClick } = props;
  return (
    // biome-ignore lint/a11y/useSemanticElements: a radio input has no room for what is chosen
    <button
      type="button"
      role="radio"
      aria-checked={on}
      className={classes.side}
      data-testid={`keep-${label.toLowerCase()}`}
      onClick={onClick}
    >
      <strong>
        {on ? "◉" : "○"} {label}
      </strong>
      {change === null ? "as it was" : change.summary}
    </button>
  );
}
