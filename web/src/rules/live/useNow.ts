import { useRobot } from "../../state/RobotContext";

/** The robot's own clock, in seconds since the epoch; this browser's may be wrong. */
export function useNow(): number {
  const { state, elapsed } = useRobot();
  return state === null ? Date.now() / 1000 : state.time + elapsed;
}
