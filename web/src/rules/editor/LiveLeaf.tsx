import type { TreePath } from "../../api/ruleTypes";
import { LeafNow } from "./LeafNow";
import { useLeafReading } from "./ProbeContext";

/** How one leaf of the form is judged right now; nothing while nobody knows. */
export function LiveLeaf(props: { root: "event.condition" | "event.clear"; path: TreePath }) {
  const reading = useLeafReading(props.root, props.path);
  return reading === null ? null : <LeafNow reading={reading} />;
}
