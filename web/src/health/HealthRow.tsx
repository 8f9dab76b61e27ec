import { Collapse, UnstyledButton } from "@mantine/core";
import { IconChevronRight } from "@tabler/icons-react";
import { type ReactNode, useId, useState } from "react";
import type { Level } from "../ui/StatusMark";
import { StatusMark } from "../ui/StatusMark";
import classes from "./Health.module.css";

interface Props {
  level: Level;
  label: string;
  /** The state in a word; left out where all is normal and the row says enough. */
  word: string;
  age: string;
  stale: boolean;
  testId: string;
  children: ReactNode;
}

/** One line of the health list; opens to the details. */
export function HealthRow({ level, label, word, age, stale, testId, children }: Props) {
  const [open, setOpen] = useState(false);
  const details = useId();
  return (
    <li className={classes.item} data-testid={testId} data-level={level}>
      <UnstyledButton
        className={classes.row}
        aria-expanded={open}
        aria-controls={details}
        onClick={() => setOpen(!open)}
      >
        <StatusMark level={level} />
        <span className={classes.label}>{label}</span>
        <span className={classes.word}>{word}</span>
        <span className={classes.age} data-stale={stale || undefined}>
          {age}
        </span>
        <IconChevronRight
          size={16}
          aria-hidden
          className={classes.chevron}
          data-open={open || undefined}
        />
      </UnstyledButton>
      <Collapse expanded={open} id={details} transitionDuration={120}>
        <div className={classes.details}>{children}</div>
      </Collapse>
    </li>
  );
}
