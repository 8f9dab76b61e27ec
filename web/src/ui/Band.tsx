import type { ReactNode } from "react";
import classes from "./Band.module.css";

interface Props {
  tone: "stale" | "stopped" | "alarm" | "notice" | "failed";
  title: string;
  children?: ReactNode;
  action?: ReactNode;
  testId?: string;
  /** Somebody has seen it: a line is enough. */
  brief?: boolean;
}

/** A message across the scene: something the operator must not overlook. */
export function Band({ tone, title, children, action, testId, brief = false }: Props) {
  return (
    <div
      className={classes.band}
      data-tone={tone}
      data-brief={brief || undefined}
      data-testid={testId}
      role={tone === "alarm" || tone === "failed" ? "alert" : "status"}
    >
      <div className={classes.text}>
        <strong>{title}</strong>
        {children !== undefined && <div className={classes.more}>{children}</div>}
      </div>
      {action}
    </div>
  );
}
