import { useRobot } from "../../state/RobotContext";
import { useLive } from "../context/RulesContext";

export interface Probation {
  revision: number;
  confirmed: number;
  /** Seconds; 0 when nothing is on probation. */
  left: number;
  notice: string;
  available: boolean;
}

/** Where the table in force stands, counting on between the robot's messages. */
export function useProbation(): Probation | null {
  const { rules, receivedAt } = useLive();
  useRobot(); // ticks
  if (rules === null || rules.revision === 0) return null;
  const { revision, confirmed, notice, available } = rules;
  const passed = (performance.now() - receivedAt) / 1000;
  const left = rules.probation_left > 0 ? Math.max(0.01, rules.probation_left - passed) : 0;
  return { revision, confirmed, left, notice, available };
}
