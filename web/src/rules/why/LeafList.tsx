import type { LeafReading } from "../../api/ruleTypes";
import { LeafNow } from "../editor/LeafNow";
import classes from "./Why.module.css";

/** Each leaf with its value, age and verdict; now, or when it fired. */
export function LeafList({
  leaves,
  then = false,
}: {
  leaves: readonly LeafReading[];
  then?: boolean;
}) {
  if (leaves.length === 0) return null;
  return (
    <ul className={classes.leaves}>
      {leaves.map((leaf) => (
        <li key={leaf.path.join(".")} data-testid="leaf">
          <code>{leaf.text}</code>
          <LeafNow reading={leaf} then={then} />
        </li>
      ))}
    </ul>
  );
}
