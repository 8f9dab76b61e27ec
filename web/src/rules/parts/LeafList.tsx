import { useMemo } from "react";
import type { Condition, LeafReading } from "../../api/ruleTypes";
import { useRules } from "../context/RulesContext";
import { conditionText, leavesOf } from "../model/condition";
import { constantNames } from "../model/ruleLines";
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
  const { graph } = useRules();
  const texts = useMemo(() => {
    const names = constantNames(graph);
    return new Map(
      (of === null ? [] : leavesOf(of)).map(({ path, leaf }) => [
        `${path.join(".")} ${conditionText(leaf)}`,
        conditionText(leaf, names),
      ]),
    );
  }, [of, graph]);
  if (leaves.length === 0) return null;
  return (
    <ul className={classes.leaves}>
      {leaves.map((leaf) => (
        <li key={leaf.path.join(".")} data-testid="leaf">
          <code>{texts.get(`${leaf.path.join(".")} ${leaf.text}`) ?? leaf.text}</code>
          <LeafNow reading={leaf} then={then} />
        </li>
      ))}
    </ul>
  );
}
