import { useMemo } from "react";
import type { Condition, LeafReading } from "../../api/ruleTypes";
import { conditionText, leavesOf } from "../model/condition";
import { plainCondition } from "../model/plain";
import { useNames } from "../model/useNames";
import { InWords } from "./InWords";
import classes from "./Leaf.module.css";
import { LeafNow } from "./LeafNow";

/** Each leaf with its value, age and verdict; now, or when it fired. */
export function LeafList({
  leaves,
  of,
  then = false,
}: {
  leaves: readonly LeafReading[];
  /** Their condition, where it is known: then its numbers are told by the names they have. */
  of: Condition | null;
  then?: boolean;
}) {
  const names = useNames();
  const texts = useMemo(() => {
    return new Map(
      (of === null ? [] : leavesOf(of)).map(({ path, leaf }) => [
        `${path.join(".")} ${conditionText(leaf)}`,
        { plain: plainCondition(leaf, names), expert: conditionText(leaf, names.constant) },
      ]),
    );
  }, [of, names]);
  if (leaves.length === 0) return null;
  return (
    <ul className={classes.leaves}>
      {leaves.map((leaf) => {
        const text = texts.get(`${leaf.path.join(".")} ${leaf.text}`);
        return (
          <li key={leaf.path.join(".")} data-testid="leaf">
            {text === undefined ? <code>{leaf.text}</code> : <InWords {...text} />}
            <LeafNow reading={leaf} then={then} />
          </li>
        );
      })}
    </ul>
  );
}
