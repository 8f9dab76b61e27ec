import { UnstyledButton } from "@mantine/core";
import type { ReactNode } from "react";
import classes from "./Toggle.module.css";

interface Props {
  on: boolean;
  onChange: (on: boolean) => void;
  /** What it switches, for who cannot see it; where it stands beside it, that is its name. */
  label: string;
  children?: ReactNode;
  disabled?: boolean;
  title?: string;
  testId?: string;
}

/** A switch that Enter and the pointer work; Space is STOP everywhere on this page. */
export function Toggle({ on, onChange, label, children, disabled = false, title, testId }: Props) {
  return (
    <UnstyledButton
      className={classes.toggle}
      role="switch"
      aria-checked={on}
      aria-label={children === undefined ? label : undefined}
      title={title}
      disabled={disabled}
      data-testid={testId}
      onClick={() => onChange(!on)}
    >
      <span className={classes.track} data-on={on || undefined} aria-hidden>
        <span className={classes.knob} />
      </span>
      {children}
    </UnstyledButton>
  );
}
