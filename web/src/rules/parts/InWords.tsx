import { UnstyledButton } from "@mantine/core";
import { useState } from "react";
import classes from "./InWords.module.css";

interface Props {
  /** As people say it. */
  plain: string;
  /** The same as the robot words it: topics, fields, numbers. */
  expert: string;
}

/** Says something plainly; the robot's own form is under the pointer, and one press away. */
export function InWords({ plain, expert }: Props) {
  const [open, setOpen] = useState(false);
  if (plain === expert) return <span>{plain}</span>;
  return (
    <span className={classes.words}>
      <UnstyledButton
        className={classes.plain}
        aria-expanded={open}
        title={expert}
        data-testid="in-words"
        onClick={() => setOpen(!open)}
      >
        {plain}
      </UnstyledButton>
      {open && <code className={classes.expert}>{expert}</code>}
    </span>
  );
}
