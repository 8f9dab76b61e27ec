import type { LocateCheck, LocateFit } from "../api/types";
import { distanceText } from "../format";
import { percentText } from "../state/localisation";

/** `Scan and map agree 97 %`, of the place that would be set. */
export function agreementText(fit: LocateFit | null | undefined): string {
  if (fit?.agreement == null) return "Scan and map cannot be compared";
  return `Scan and map agree ${percentText(fit.agreement)}`;
}

/** How the best place lies to the one that was pressed; empty where that is the best. */
export function movedText({ here, best }: LocateCheck): string {
  if (here == null || best == null) return "";
  const metres = Math.hypot(best.x - here.x, best.y - here.y);
  const turn = best.yaw - here.yaw;
  const degrees = Math.abs(
    Math.round((Math.atan2(Math.sin(turn), Math.cos(turn)) * 180) / Math.PI),
  );
  const at = here.agreement == null ? "" : `, where they agree ${percentText(here.agreement)}`;
  const turned = degrees === 0 ? "" : ` and ${degrees}°`;
  return `The best place is ${distanceText(metres)}${turned} from the one you pressed${at}.`;
}
