import { Button } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { useState } from "react";
import { rollbackRules } from "../../api/rulesClient";
import type { Revision } from "../../api/ruleTypes";
import { useNow } from "../../state/RobotContext";
import { Problem } from "../../ui/Problem";
import page from "../../ui/page.module.css";
import { useRules } from "../context/RulesContext";
import { whenText } from "../model/words";
import { Day } from "../parts/Day";
import { DiffList } from "../parts/DiffList";
import classes from "./History.module.css";

const ORIGIN_WORDS: Record<Revision["origin"], string> = {
  recipe: "from the recipe",
  edit: "edited",
  rollback: "rolled back",
  "taken back": "taken back",
  merge: "merged",
};

interface Props {
  revision: Revision;
  active: number;
  startOpen: boolean;
  /** When the one above it was made; null for the newest. Epoch s. */
  newer: number | null;
}

/** One revision: who, when, why, what; and one click back to it. Probation is the undo. */
export function RevisionRow({ revision, active, startOpen, newer }: Props) {
  const { mayEdit, reload } = useRules();
  const now = useNow();
  const [open, setOpen] = useState(startOpen);
  const { number, author, role, time, reason, origin, outcome, restores, diff } = revision;
  const current = number === active;
  const count = diff.changes.length;
  const rollBack = useMutation({
    mutationFn: () => rollbackRules(number, active, `back to revision ${number}`),
    onSuccess: reload,
  });
  return (
    <li
      className={classes.revision}
      data-testid={`revision-${number}`}
      data-current={current || undefined}
    >
      <Day time={time} newer={newer ?? now} of="en" />
      <div className={classes.head}>
        <strong>rev {number}</strong>
        <span>{author === role ? author : `${author}, ${role}`}</span>
        <span className={classes.outcome}>
          {current ? (outcome === "confirmed" ? "in force ✓" : "in force, on probation") : outcome}
        </span>
        <time className={classes.when} dateTime={new Date(time * 1000).toISOString()}>
          {whenText(time, now)}
        </time>
      </div>
      <div className={classes.why}>
        {ORIGIN_WORDS[origin]}
        {restores !== null && ` to revision ${restores}`}
        {reason !== "" && `: ${reason}`}
      </div>
      <div className={page.line}>
        {count > 0 && (
          <Button
            variant="subtle"
            size="compact-md"
            aria-expanded={open}
            onClick={() => setOpen(!open)}
          >
            {count === 1 ? "1 change" : `${count} changes`}
          </Button>
        )}
        {mayEdit && !current && (
          <Button
            variant="default"
            size="compact-md"
            loading={rollBack.isPending}
            onClick={() => rollBack.mutate()}
            data-testid="roll-back"
          >
            Roll back to this
          </Button>
        )}
      </div>
      <Problem error={rollBack.error} />
      {open && <DiffList changes={diff.changes} />}
    </li>
  );
}
