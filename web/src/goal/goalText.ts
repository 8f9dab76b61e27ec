import type { Drive, Goal, GoalCheck } from "../api/types";
import { degreesText, distanceText, durationText, signed, wholeAgeText } from "../format";
import type { Cause } from "../state/causes";

/** How a line is meant: calm, good news, or something for a person. */
type Tone = "plain" | "done" | "problem";

export interface GoalLine {
  tone: Tone;
  text: string;
  /** What to do, where something is to be done. */
  more: string;
}

/** `4.2 m, about 21 s, clear`: what will happen if the operator says Go. */
export function checkText(check: GoalCheck): string {
  if (!check.ok) return check.message;
  const parts: string[] = [];
  if (check.length !== null) parts.push(distanceText(check.length));
  if (check.duration !== null) parts.push(`about ${durationText(check.duration)}`);
  parts.push(parts.length === 0 ? "Clear" : "clear");
  return parts.join(", ");
}

const clock = new Intl.DateTimeFormat(undefined, { timeStyle: "short", hour12: false });

/** When a goal ended: relative within a minute, clock time after. `ago` in s, `now` in epoch s. */
export function endText(ago: number, now: number): string {
  return ago < 60 ? `${wholeAgeText(ago)} ago` : `at ${clock.format((now - ago) * 1000)}`;
}

export function placeText(x: number, y: number, yaw: number | null): string {
  const place = `x ${signed(x, 2)}, y ${signed(y, 2)} m`;
  return yaw === null ? place : `${place}, heading ${degreesText(yaw)}`;
}

/** A planner answers a goal at once; later than this, something is wrong. */
const ACCEPT_WITHIN_S = 3;

/**
 * @param drive says who has stopped the robot, which need not be who ended the goal
 * @param cause what is wrong with the robot now; another point would not help
 */
export function goalLine(goal: Goal, drive: Drive | null, cause: Cause | null = null): GoalLine {
  switch (goal.phase) {
    case "sent":
      return goal.elapsed < ACCEPT_WITHIN_S
        ? line("plain", "Goal sent")
        : line(
            "problem",
            `Sent ${durationText(goal.elapsed)} ago, not accepted yet`,
            cause === null
              ? "Look at the planner's health; cancel the goal or send it again."
              : `${cause.text}. ${cause.advice}`,
          );
    case "accepted":
      return line("plain", "Goal accepted");
    case "driving":
      return line("plain", remaining(goal));
    case "arrived":
      return line("done", goal.error === null ? "Arrived" : `Arrived, ${offText(goal.error)} off`);
    case "failed":
      return line(
        "problem",
        goal.message === "" ? "The goal failed" : goal.message,
        afterwards(goal, drive, cause),
      );
    case "canceled":
      return line("plain", "Goal cancelled", goal.message);
  }
}

function afterwards(goal: Goal, drive: Drive | null, cause: Cause | null): string {
  if (drive === null || !drive.stopped) {
    if (cause === null || cause.minor) return "Pick another point, or send the goal again.";
    return `${cause.text}. When that is mended, send the goal again.`;
  }
  const by = drive.stopped_by === "" ? "somebody" : drive.stopped_by;
  return goal.message.includes(by)
    ? "When STOP is released, send the goal again."
    : `That was before ${by} stopped the robot.`;
}

function offText(error: number): string {
  return Math.abs(error) < 0.005 ? "less than 1 cm" : distanceText(error);
}

/** `1.2 m left, about 8 s`. */
export function remaining(goal: Goal): string {
  if (goal.distance_left === null) return "On the way";
  const left = `${distanceText(goal.distance_left)} left`;
  return goal.eta === null ? left : `${left}, about ${durationText(goal.eta)}`;
}

function line(tone: Tone, text: string, more = ""): GoalLine {
  return { tone, text, more };
}

export function isUnderWay(goal: Goal | null): boolean {
  return goal !== null && ["sent", "accepted", "driving"].includes(goal.phase);
}

const HELD: Record<string, string> = {
  obstacle: "an obstacle is close",
  "keep-out zone": "a keep-out zone",
  "speed zone": "a speed zone",
  "place unknown": "it does not know where it is, and there are zones",
  "second publisher": "another program commands it, too",
  "scan stale": "a scanner or camera is silent",
  "odometry stale": "no odometry arrives",
  "steered wheels": "steered wheels turn only while it drives",
  "command stale": "no commands arrive",
};

/** Why the robot is slower than it was told to be; null when nothing holds it. */
export function limitText(drive: Drive | null): string | null {
  if (drive === null || drive.stopped || drive.limited_by === "") return null;
  const why = HELD[drive.limited_by] ?? drive.limited_by;
  const percent = Math.round(drive.speed_factor * 100);
  if (percent >= 100) return null;
  return percent <= 0 ? `Held: ${why}` : `Slowed to ${percent} %: ${why}`;
}
