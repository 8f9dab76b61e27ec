import { UnstyledButton } from "@mantine/core";
import { useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import { leftText } from "../model/words";
import classes from "./RevisionBadge.module.css";
import { useProbation } from "./useProbation";

/** The revision in force, in the top bar: kept, or still on probation and for how long. */
export function RevisionBadge() {
  const probation = useProbation();
  const { draft } = useRules();
  const nav = useNav();
  if (probation === null) return null;
  const { revision, confirmed, left, available } = probation;
  const state = !available
    ? "silent"
    : left > 0
      ? `▲ probation ${leftText(left)}`
      : revision === confirmed
        ? "✓ confirmed"
        : "not confirmed";
  const unsaved = draft.changes.length;
  return (
    <UnstyledButton
      className={classes.badge}
      data-probation={left > 0 || undefined}
      data-unsaved={unsaved > 0 || undefined}
      data-silent={!available || undefined}
      data-testid="revision-badge"
      title="Open the rules (R)"
      onClick={() => nav.go(nav.place)}
    >
      <span className={classes.revision}>rev {revision}</span>{" "}
      <span className={classes.state}>{state}</span>
      {unsaved > 0 && (
        <span className={classes.unsaved} title="Unsaved changes">
          ✎ {unsaved}
          <span className="visually-hidden"> unsaved changes</span>
        </span>
      )}
    </UnstyledButton>
  );
}
