import type { Drive, Goal, GoalCheck } from "../api/types";
import { degreesText, distanceText, durationText, pointText, wholeAgeText } from "../format";
import type { Cause } from "../state/causes";
import { timeText } from "../texts/dates";
import { type Phrase, t } from "../texts/text";
import { told } from "../texts/told";
import { METRES_PER_FOOT, units } from "../texts/units";

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
  if (!check.ok) return told(check.message);
  const parts: string[] = [];
  if (check.length !== null) parts.push(distanceText(check.length));
  if (check.duration !== null)
    parts.push(t("about {duration}", { duration: durationText(check.duration) }));
  parts.push(parts.length === 0 ? t("Clear") : t("clear"));
  return parts.join(", ");
}

/** When a goal ended: relative within a minute, clock time after. `ago` in s, `now` in epoch s. */
export function endText(ago: number, now: number): string {
  return ago < 60
    ? t("{age} ago", { age: wholeAgeText(ago) })
    : t("at {time}", { time: timeText(now - ago, "short") });
}

export function placeText(x: number, y: number, yaw: number | null): string {
  const place = pointText(x, y);
  return yaw === null
    ? place
    : t("{place}, heading {degrees}", { place, degrees: degreesText(yaw) });
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
        ? line("plain", t("Goal sent"))
        : line(
            "problem",
            t("Sent {duration} ago, not accepted yet", { duration: durationText(goal.elapsed) }),
            cause === null
              ? t("Look at the planner's health; cancel the goal or send it again.")
              : `${cause.text}. ${cause.advice}`,
          );
    case "accepted":
      return line("plain", t("Goal accepted"));
    case "driving":
      return line("plain", remaining(goal));
    case "arrived":
      return line(
        "done",
        goal.error === null ? t("Arrived") : t("Arrived, {off} off", { off: offText(goal.error) }),
      );
    case "failed":
      return line(
        "problem",
        goal.message === "" ? t("The goal failed") : told(goal.message),
        afterwards(goal, drive, cause),
      );
    case "canceled":
      return line("plain", t("Goal cancelled"), told(goal.message));
  }
}

/** How what the robot has found begins, as it says it. */
const IN_THE_WAY = "In the way: ";

function afterwards(goal: Goal, drive: Drive | null, cause: Cause | null): string {
  if (drive === null || !drive.stopped) {
    // What stood in its way does not go by what else may be wrong.
    if (cause === null || cause.minor || goal.message.includes(IN_THE_WAY))
      return t("Pick another point, or send the goal again.");
    return t("{text}. When that is mended, send the goal again.", { text: cause.text });
  }
  const by = drive.stopped_by === "" ? t("somebody") : told(drive.stopped_by);
  return goal.message.includes(drive.stopped_by || "somebody")
    ? t("When STOP is released, send the goal again.")
    : t("That was before {by} stopped the robot.", { by });
}

function offText(error: number): string {
  return Math.abs(error) < 0.005
    ? t("less than {distance}", {
        distance: distanceText(units.get() === "metric" ? 0.01 : METRES_PER_FOOT / 12),
      })
    : distanceText(error);
}

/** Of the way that is left, m: less is told of no more, for what is left is to turn. */
const THERE = 0.02;

/** `1.2 m left, about 8 s`. */
export function remaining(goal: Goal): string {
  if (goal.distance_left === null) return t("On the way");
  if (goal.distance_left < THERE && goal.yaw !== null) return t("There; turns to its heading");
  const left = t("{distance} left", { distance: distanceText(goal.distance_left) });
  return goal.eta === null || goal.hindrance !== ""
    ? left
    : t("{left}, about {duration}", { left, duration: durationText(goal.eta) });
}

function line(tone: Tone, text: string, more = ""): GoalLine {
  return { tone, text, more };
}

export function isUnderWay(goal: Goal | null): boolean {
  return goal !== null && ["sent", "accepted", "driving"].includes(goal.phase);
}

const HELD: Record<string, Phrase> = {
  obstacle: "an obstacle is close",
  "keep-out zone": "a keep-out zone",
  "speed zone": "a speed zone",
  "place unknown": "it does not know where it is, and there are zones",
  "second publisher": "another program commands it, too",
  "scan stale": "a scanner or camera is silent",
  "odometry stale": "no fresh odometry arrives",
  "steered wheels": "steered wheels turn only while it drives",
  "command stale": "no commands arrive",
};

/** Why the robot is slower than it was told to be; null when nothing holds it. */
export function limitText(drive: Drive | null): string | null {
  if (drive === null || drive.stopped || drive.limited_by === "") return null;
  const known = HELD[drive.limited_by];
  const why = known === undefined ? told(drive.limited_by) : t(known);
  const percent = Math.round(drive.speed_factor * 100);
  if (percent >= 100) return null;
  return percent <= 0
    ? t("Held: {why}", { why })
    : t("Slowed to {percent} %: {why}", { percent, why });
}
