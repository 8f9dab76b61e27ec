import classes from "./Editor.module.css";
import { useReading } from "./ProbeContext";
import { VerdictMark, verdictWord } from "./VerdictMark";

/** What the robot makes of a whole condition right now. */
export function VerdictLine({ of }: { of: "condition" | "clear" }) {
  const reading = useReading();
  if (reading === null) return null;
  const verdict = of === "clear" ? reading.clear_verdict : reading.verdict;
  return (
    <span className={classes.verdict} data-testid={`probe-${of}`}>
      {reading.error !== "" ? (
        <span className={classes.wrong}>{reading.error}</span>
      ) : (
        <>
          now <VerdictMark verdict={verdict} /> {verdictWord(verdict)}
        </>
      )}
    </span>
  );
}
