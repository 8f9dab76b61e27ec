import type { Drive } from "../api/types";

/**
 * What is known of a drive manager that does not answer; null while it does.
 *
 * A stop that was reported last is told: the robot comes up as it was.
 */
export function silentDriveText(drive: Drive | null, elapsed: number): string | null {
  if (drive?.available) return null;
  if (drive === null) {
    return "No drive manager was found on the network. Start the stack, or use the robot's own button.";
  }
  const age = Math.round(drive.age + elapsed);
  const last = `The drive manager was last heard ${age} s ago`;
  if (!drive.stopped) return `${last}. Use the robot's own button; Health says what is wrong.`;
  const by = drive.stopped_by === "" ? "" : ` by ${drive.stopped_by}`;
  return `${last}; the robot was stopped${by}, and stays so until somebody releases it. Health says what is wrong.`;
}
