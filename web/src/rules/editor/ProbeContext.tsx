import { createContext, type ReactNode, useContext } from "react";
import type { Condition, LeafReading, ProbeReading, TreePath } from "../../api/ruleTypes";
import { useProbe } from "../live/useProbe";
import { samePath } from "../model/condition";

const ProbeContext = createContext<ProbeReading | null>(null);

interface Props {
  condition: Condition;
  clear: Condition | null;
  children: ReactNode;
}

/** Lets the form's small live parts follow the robot without drawing the whole form each time. */
export function ProbeProvider({ condition, clear, children }: Props) {
  return <ProbeContext value={useProbe(condition, clear)}>{children}</ProbeContext>;
}

/** How the robot judges what is being written; null while nobody knows. */
export const useReading = (): ProbeReading | null => useContext(ProbeContext);

/** How one leaf is judged right now. */
export function useLeafReading(
  root: "event.condition" | "event.clear",
  path: TreePath,
): LeafReading | null {
  const reading = useReading();
  const leaves = root === "event.clear" ? reading?.clear_leaves : reading?.leaves;
  return leaves?.find((leaf) => samePath(leaf.path, path)) ?? null;
}
