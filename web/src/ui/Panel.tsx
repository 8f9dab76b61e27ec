import type { ReactNode } from "react";
import classes from "./Panel.module.css";

interface Props {
  title: string;
  /** Said in place of the contents, where there are none. */
  empty: string | null;
  /** What it shows is of the past. */
  frozen?: boolean;
  testId?: string;
  children: ReactNode;
}

/** One titled part of the column beside the scene. */
export function Panel({ title, empty, frozen = false, testId, children }: Props) {
  return (
    <section
      className={classes.panel}
      data-frozen={frozen || undefined}
      data-testid={testId}
      aria-label={title}
    >
      <h2 className={classes.title}>{title}</h2>
      {empty === null ? children : <p className={classes.empty}>{empty}</p>}
    </section>
  );
}
