import { listPlaces } from "../api/placesClient";
import { useAsked } from "../api/queries";
import { useRobot } from "../state/RobotContext";

/** The robot's places: asked again when somebody changed one, or the robot has another map. */
export function usePlaces() {
  const { state } = useRobot();
  const now = state?.places;
  const { data: list, error } = useAsked({
    key: ["places", now?.available ?? false, now?.revision ?? 0, now?.map ?? null],
    ask: listPlaces,
    enabled: now !== undefined,
    keep: true,
  });
  return { list, error };
}
