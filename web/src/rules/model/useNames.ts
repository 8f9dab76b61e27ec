import { useMemo } from "react";
import { useRobot } from "../../state/RobotContext";
import { useRules } from "../context/RulesContext";
import { type Names, titleOf } from "./plain";
import { constantNames } from "./ruleLines";

/** What this robot's things are called by its people. */
export function useNames(): Names {
  const { graph } = useRules();
  const { state } = useRobot();
  // The state is another each time it comes; how components are called is not.
  const called = JSON.stringify(state?.components.map(({ name, label }) => [name, label]) ?? []);
  return useMemo(() => {
    const labels = new Map<string, string>(JSON.parse(called));
    return {
      component: (name) => labels.get(name) ?? titleOf(name),
      constant: constantNames(graph),
      graph,
    };
  }, [called, graph]);
}
