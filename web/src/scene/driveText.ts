import type { Drive } from "../api/types";
import { t } from "../texts/text";
import { told } from "../texts/told";

/**
 * What is known of a drive manager that does not answer; null while it does.
 *
 * A stop that was reported last is told: the robot comes up as it was.
 */
export function silentDriveText(drive: Drive | null, elapsed: number): string | null {
  if (drive?.available) return null;
  if (drive === null) {
    return t(
      "No drive manager was found on the network. Start the stack, or use the robot's own button.",
    );
  }
  const age = Math.round(drive.age + elapsed);
  const last = t("The drive manager was last heard {age} s ago", { age });
  if (!drive.stopped)
    return t("{last}. Use the robot's own button; Health says what is wrong.", { last });
  const by = drive.stopped_by === "" ? t("somebody") : told(drive.stopped_by);
  return t(
    "{last}; the robot was stopped by {by}, and stays so until somebody releases it. Health says what is wrong.",
    { last, by },
  );
}
