import type { Component, State, Stream } from "../api/types";
import { wholeAgeText } from "../format";
import { type Phrase, t } from "../texts/text";
import { told } from "../texts/told";
import type { Level } from "../ui/StatusMark";
import type { Cause } from "./causes";

/** A view without a message for this long is frozen; a component or drive as silent is unknown. */
export const FROZEN_S = 1.5;
/** A component's row tells of its restart for an hour; its details do so for good. */
const RESTART_KEPT_S = 3600;
/** The robot's position comes at 50 Hz; half a second without one is a fault, not a hiccup. */
export const POSE_DEADLINE_S = 0.5;

const LEVELS: Record<Component["status"], Level> = {
  healthy: "healthy",
  algorithm_failure: "degraded",
  component_failure: "failed",
  system_failure: "failed",
  general_failure: "failed",
  silent: "unknown",
};

const WORDS: Record<Component["status"], Phrase> = {
  healthy: "Healthy",
  algorithm_failure: "No solution",
  component_failure: "Failed",
  system_failure: "Waits",
  general_failure: "Failed",
  silent: "Silent",
};

/** What its supervisor knows better than a component that cannot speak. */
const LOST_WORDS: Partial<Record<NonNullable<Component["process"]>["state"], Phrase>> = {
  dead: "Dead",
  stuck: "Stuck",
  "given up": "Given up",
};

/** @param elapsed seconds since the snapshot came; a value goes on ageing while nothing arrives. */
export function componentLevel(component: Component, elapsed: number): Level {
  if (LOST_WORDS[component.process?.state ?? "unknown"] !== undefined) return "failed";
  return component.age + elapsed > FROZEN_S ? "unknown" : LEVELS[component.status];
}

export function componentWord(component: Component, elapsed: number): string {
  const lost = LOST_WORDS[component.process?.state ?? "unknown"];
  if (lost !== undefined) return t(lost);
  if (component.age + elapsed > FROZEN_S) return t(WORDS.silent);
  const restarted = component.process?.restarted ?? null;
  // Who was killed comes back by itself, and somebody may want to know why.
  if (component.status === "healthy" && restarted !== null && restarted < RESTART_KEPT_S) {
    return t("Restarted {age} ago", { age: wholeAgeText(restarted) });
  }
  // What is outside is named by the component; without it, all that is known is that it failed.
  if (component.status === "system_failure" && component.src_topics.length === 0)
    return t("Failed");
  return t(WORDS[component.status]);
}

export function streamStale(stream: Stream, elapsed: number): boolean {
  if (stream.stale || stream.age === null) return true;
  return stream.deadline !== null && stream.age + elapsed > stream.deadline;
}

/** While the view is frozen nothing is known about a stream, not even that it is late. */
export function streamLevel(stream: Stream, elapsed: number): Level {
  if (stream.age === null) return stream.key === "path" ? "healthy" : "unknown";
  if (elapsed > FROZEN_S) return "unknown";
  return streamStale(stream, elapsed) ? "degraded" : "healthy";
}

export interface Overall {
  level: Level;
  text: string;
}

/**
 * The one line of the top bar.
 *
 * @param cause what is behind all that is wrong, as far as that is known
 * @param restart who has just been started again, in words
 */
export function overall(
  state: State | null,
  elapsed: number,
  cause: Cause | null,
  restart: string | null = null,
): Overall {
  if (state === null) return { level: "unknown", text: t("Connecting") };
  if (elapsed > FROZEN_S)
    return {
      level: "unknown",
      text: t("No data for {age}", { age: wholeAgeText(elapsed) }),
    };
  if (state.components.length === 0) return { level: "unknown", text: t("No components found") };
  if (cause !== null) {
    const { level, name, others } = cause;
    return { level, text: others === 0 ? name : t("{name}, and {others} more", { name, others }) };
  }
  // Where each blames another nobody is the cause: they are counted.
  const rows = state.components.map((c) => ({
    label: told(c.label),
    level: componentLevel(c, elapsed),
  }));
  for (const [level, text] of [
    ["failed", "{n, plural, one {{first} failed} other {# components failed}}"],
    ["degraded", "{n, plural, one {{first} degraded} other {# components degraded}}"],
    ["unknown", "{n, plural, one {{first} silent} other {# components silent}}"],
  ] as const) {
    const bad = rows.filter((row) => row.level === level);
    const first = bad[0];
    if (first === undefined) continue;
    return { level, text: t(text, { n: bad.length, first: first.label }) };
  }
  if (state.pose === null) return { level: "unknown", text: t("Position unknown") };
  const { alarms, available, age } = state.rules;
  // Who heals the robot is dead or hangs: a component that fails now is not answered.
  if (!available && age !== null) {
    const silence = wholeAgeText(age + elapsed);
    return { level: "degraded", text: t("Rules silent for {age}", { age: silence }) };
  }
  if (alarms > 0) {
    return {
      level: "degraded",
      text: t("{alarms, plural, one {One alarm} other {# alarms}}", { alarms }),
    };
  }
  if (state.battery?.low && !state.battery.charging) {
    return { level: "degraded", text: t("Battery low") };
  }
  // A robot that may not move is not well, whatever its components say.
  const well = state.drive?.stopped ? t("No faults") : t("All well");
  return { level: "healthy", text: restart === null ? well : `${well} · ${restart}` };
}
