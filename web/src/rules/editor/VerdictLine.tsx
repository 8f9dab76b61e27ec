import type { ProbeReading } from "../../api/ruleTypes";
import classes from "./Editor.module.css";
import { VerdictMark, verdictWord } from "./VerdictMark";

/** What the robot makes of the whole condition right now. */
export function VerdictLine({ reading }: { reading: ProbeReading | null }) {
  if (reading === null) return null;
  return (
    <span className={classes.verdict} data-testid="probe-verdict" aria-live="polite">
      {reading.error !== "" ? (
        <span className={classes.wrong}>{reading.error}</span>
      ) : (
        <>
          now <VerdictMark verdict={reading.verdict} /> {verdictWord(reading.verdict)}
        </>
      )}
    </span>
  );
}
