import type { Drive } from "../api/types";
import { limitText } from "../goal/goalText";
import { t } from "../texts/text";

/** What keeps the robot from doing what the hand asks for; null when nothing does. */
export function heldBackText(drive: Drive | null): string | null {
  if (drive === null) return t("The drive manager is silent: the robot stands.");
  if (drive.stopped) return t("Stopped: release the stop, then drive.");
  if (drive.limited_by === "let go first") return t("Let go first, then drive.");
  if (drive.limited_by === "steered wheels")
    return t("Its wheels are steered: to turn, push ahead or back, too.");
  if (drive.limited_by === "command stale") return t("The hand is not heard: the robot stands.");
  return limitText(drive);
}

/** Who drives by hand, for everybody else. */
export function drivenText(drivenBy: string, yours: boolean): string {
  return yours ? t("You drive") : t("Driven by {drivenBy}", { drivenBy });
}
