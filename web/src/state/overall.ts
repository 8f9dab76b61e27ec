import type { Component, State, Stream } from "../api/types";
import { wholeAgeText } from "../format";
import type { Level } from "../ui/StatusMark";

/** A view without a message for this long is frozen; a component or drive as silent is unknown. */
export const FROZEN_S = 1.5;
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

const WORDS: Record<Component["status"], string> = {
  healthy: "Healthy",
  algorithm_failure: "Algorithm failure",
  component_failure: "Component failure",
  system_failure: "System failure",
  general_failure: "General failure",
  silent: "Silent",
};

/** What its supervisor knows better than a component that cannot speak. */
const LOST_WORDS: Partial<Record<NonNullable<Component["process"]>["state"], string>> = {
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
  if (lost !== undefined) return lost;
  return component.age + elapsed > FROZEN_S ? WORDS.silent : WORDS[component.status];
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

/** The one line of the top bar. */
export function overall(state: State | null, elapsed: number): Overall {
  if (state === null) return { level: "unknown", text: "Connecting" };
  if (elapsed > FROZEN_S) return { level: "unknown", text: `No data for ${wholeAgeText(elapsed)}` };
  if (state.components.length === 0) return { level: "unknown", text: "No components found" };
  const rows = state.components.map((c) => ({ label: c.label, level: componentLevel(c, elapsed) }));
  for (const [level, word] of [
    ["failed", "failed"],
    ["degraded", "degraded"],
    ["unknown", "silent"],
  ] as const) {
    const bad = rows.filter((row) => row.level === level);
    const first = bad[0];
    if (first === undefined) continue;
    return {
      level,
      text: bad.length === 1 ? `${first.label} ${word}` : `${bad.length} components ${word}`,
    };
  }
  if (state.pose === null) return { level: "unknown", text: "Position unknown" };
  const late = state.streams.find((s) => s.age !== null && streamStale(s, elapsed));
  if (late !== undefined) return { level: "degraded", text: `${late.label} is late` };
  // A robot that may not move is not well, whatever its components say.
  return { level: "healthy", text: state.drive?.stopped ? "No faults" : "All well" };
}
