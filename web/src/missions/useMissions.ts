import { listMissions } from "../api/missionsClient";
import { useAsked } from "../api/queries";
import { useRobot } from "../state/RobotContext";

/** The robot's missions: asked again when somebody changed one, or the robot has another map. */
export function useMissions() {
  const { state } = useRobot();
  const now = state?.missions;
  const { data: list, error } = useAsked({
    key: ["missions", now?.available ?? false, now?.revision ?? 0, state?.places.map ?? null],
    ask: listMissions,
    enabled: now !== undefined,
    keep: true,
  });
  return { list, error };
}
