import type { Place } from "../api/types";
import { t } from "../texts/text";
import { useMissions } from "./useMissions";

/** Which missions go to a place; nothing where none does. */
export function MissionsTo({ place }: { place: Place }) {
  const names = (useMissions().list?.missions ?? [])
    .filter(({ waypoints }) => waypoints.some((waypoint) => waypoint.place === place.id))
    .map(({ name }) => name)
    .join(", ");
  return names === "" ? null : <> {t("Missions that go there: {names}.", { names })}</>;
}
