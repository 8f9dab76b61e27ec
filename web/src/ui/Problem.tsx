import { langOf, told } from "../texts/told";
import classes from "./page.module.css";

interface Props {
  /** What went wrong, and what to do; nothing is shown where nothing did. */
  error: { title: string; remedy: string } | null;
  testId?: string;
}

/** A failure in the place where it matters. */
export function Problem({ error, testId }: Props) {
  return error === null ? null : (
    <p className={classes.problem} role="alert" data-testid={testId} lang={langOf(error.title)}>
      {told(error.title)} {told(error.remedy)}
    </p>
  );
}
