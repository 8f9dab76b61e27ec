import { asApiError } from "../api/errors";
import { langOf, told } from "../texts/told";
import classes from "./page.module.css";

interface Props {
  /** What went wrong, and what to do; nothing is shown where nothing did. */
  error: Error | { title: string; remedy: string } | null;
  testId?: string;
}

/** A failure in the place where it matters. */
export function Problem({ error, testId }: Props) {
  if (error === null) return null;
  const { title, remedy } = "title" in error ? error : asApiError(error);
  return (
    <p className={classes.problem} role="alert" data-testid={testId} lang={langOf(title)}>
      {told(title)} {told(remedy)}
    </p>
  );
}
