import type { Drive } from "../api/types";
import { limitText } from "../goal/goalText";

/** What keeps the robot from doing what the hand asks for; null when nothing does. */
export function heldBackText(drive: Drive | null): string | null {
  if (drive === null) return "The drive manager is silent: the robot stands.";
  if (drive.stopped) return "Stopped: release the stop, then drive.";
  if (drive.limited_by === "let go first") return "Let go first, then drive.";
  if (drive.limited_by === "steered wheels")
    return "Its wheels are steered: to turn, push ahead or back, too.";
  if (drive.limited_by === "command stale") return "The hand is not heard: the robot stands.";
  return limitText(drive);
}

/** Who drives by hand, for everybody else. */
export function drivenText(drivenBy: string, yours: boolean): string {
  return yours ? "You drive" : `Driven by ${drivenBy}`;
}
