import type { LeafReading } from "../../api/ruleTypes";
import { ageText } from "../../format";
import { valueText } from "../model/actions";
import classes from "./Leaf.module.css";
import { VerdictMark, verdictWord } from "./VerdictMark";

/** A leaf as the robot judges it: `now 0.42 → false · 0.08 s`. */
export function LeafNow({ reading, then = false }: { reading: LeafReading; then?: boolean }) {
  const { value, verdict, age } = reading;
  return (
    <span className={classes.now} data-verdict={verdict ?? "unknown"} data-testid="leaf-now">
      {then ? "was" : "now"} {value === null ? "no value" : nowText(reading)}
      {" → "}
      <VerdictMark verdict={verdict} /> {verdictWord(verdict)}
      {age !== null && (
        <span className={classes.age}> · {age < 1 ? `${age.toFixed(2)} s` : ageText(age)}</span>
      )}
    </span>
  );
}

function nowText({ value, text }: LeafReading): string {
  // Of one that waits for any message, the robot tells the type.
  if (text.endsWith(" received")) return "a message";
  if (typeof value !== "number") return valueText(value);
  return Number.isInteger(value) ? String(value) : String(Number(value.toPrecision(4)));
}
