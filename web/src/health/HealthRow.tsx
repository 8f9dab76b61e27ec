import { Collapse, UnstyledButton } from "@mantine/core";
import { IconChevronRight } from "@tabler/icons-react";
import { type ReactNode, useCallback, useId, useState } from "react";
import { memoInLanguage } from "../texts/memoInLanguage";
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

/** One line of the health list; opens to the details, which are not made before. */
export function HealthRow({ children, testId, ...head }: Props) {
  const [open, setOpen] = useState<boolean | null>(null);
  const details = useId();
  const toggle = useCallback(() => setOpen((was) => was !== true), []);
  return (
    <li className={classes.item} data-testid={testId} data-level={head.level}>
      <Head {...head} open={open === true} details={details} onToggle={toggle} />
      {open !== null && (
        <Collapse expanded={open} id={details} transitionDuration={120}>
          <div className={classes.details}>{children}</div>
        </Collapse>
      )}
    </li>
  );
}

interface HeadProps extends Omit<Props, "testId" | "children"> {
  open: boolean;
  /** Id of the element that it opens. */
  details: string;
  onToggle: () => void;
}

/** Apart, for most of what arrives of a robot that is well changes none of its words. */
const Head = memoInLanguage(function Head(props: HeadProps) {
  const { level, label, word, age, stale, open, details, onToggle } = props;
  return (
    <UnstyledButton
      className={classes.row}
      aria-expanded={open}
      aria-controls={details}
      onClick={onToggle}
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
  );
});
