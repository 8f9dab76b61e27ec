import type { LocateCheck, LocateFit } from "../api/types";
import { distanceText } from "../format";
import { percentText } from "../state/localisation";
import { t } from "../texts/text";

/** `Scan and map agree 97 %`, of the place that would be set. */
export function agreementText(fit: LocateFit | null | undefined): string {
  if (fit?.agreement == null) return t("Scan and map cannot be compared");
  return t("Scan and map agree {percent}", { percent: percentText(fit.agreement) });
}

/** How the best place lies to the one that was pressed; empty where that is the best. */
export function movedText({ here, best }: LocateCheck): string {
  if (here == null || best == null) return "";
  const metres = Math.hypot(best.x - here.x, best.y - here.y);
  const turn = best.yaw - here.yaw;
  const degrees = Math.abs(
    Math.round((Math.atan2(Math.sin(turn), Math.cos(turn)) * 180) / Math.PI),
  );
  const by =
    degrees === 0
      ? distanceText(metres)
      : t("{distance} and {degrees}°", { distance: distanceText(metres), degrees });
  if (here.agreement == null) return t("The best place is {by} from the one you pressed.", { by });
  const agreement = percentText(here.agreement);
  return t("The best place is {by} from the one you pressed, where they agree {agreement}.", {
    by,
    agreement,
  });
}
