import { useAsked } from "../api/queries";
import { listZones } from "../api/zonesClient";
import { useRobot } from "../state/RobotContext";

/** The robot's zones: asked again when somebody changed one, or the robot has another map. */
export function useZones() {
  const { state } = useRobot();
  const now = state?.zones;
  const { data: list, error } = useAsked({
    key: [
      "zones",
      now?.available ?? false,
      now?.revision ?? 0,
      now?.masks ?? 0,
      state?.places.map ?? null,
    ],
    ask: listZones,
    enabled: now !== undefined,
    keep: true,
  });
  return { list, error };
}
