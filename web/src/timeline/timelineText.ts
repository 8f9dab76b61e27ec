import type { TimelineEntry, TimelineKind, TimelineLevel } from "../api/types";
import { durationText } from "../format";
import type { Level } from "../ui/StatusMark";

/** What happens, in the order of its lanes: what stops the robot first. */
export const KINDS: readonly { kind: TimelineKind; label: string }[] = [
  { kind: "stop", label: "STOP" },
  { kind: "fault", label: "Faults" },
  { kind: "alarm", label: "Alarms" },
  { kind: "rule", label: "Rules" },
  { kind: "goal", label: "Goals" },
  { kind: "mission", label: "Missions" },
  { kind: "hand", label: "By hand" },
  { kind: "edit", label: "Edits" },
  { kind: "person", label: "People" },
  { kind: "robot", label: "Robot" },
];

const MARKS: Record<TimelineLevel, Level> = {
  info: "healthy",
  warning: "degraded",
  error: "failed",
  critical: "failed",
};

export const markOf = (level: TimelineLevel): Level => MARKS[level];

export const kindLabel = (kind: TimelineKind): string =>
  KINDS.find((each) => each.kind === kind)?.label ?? kind;

/**
 * What stands behind the title: how long it lasted, or how often it came.
 *
 * @param now seconds since the epoch.
 */
export function lengthText(entry: TimelineEntry, now: number): string {
  const parts: string[] = [];
  if (entry.lasts) parts.push(`for ${durationText(Math.max(0, now - entry.time))} by now`);
  else if (entry.ended === null) parts.push("end not seen");
  else if (entry.count === 1 && entry.ended - entry.time >= 0.5)
    parts.push(durationText(entry.ended - entry.time));
  if (entry.count > 1) {
    const over = Math.max(entry.last, entry.ended ?? entry.time) - entry.time;
    parts.push(`${entry.count} times${over >= 1 ? ` in ${durationText(over)}` : ""}`);
  }
  return parts.join(", ");
}

/** What an entry is about, before its title: a component's label, or that it is a rule. */
export function sourceText(entry: TimelineEntry, labels: ReadonlyMap<string, string>): string {
  if (entry.kind === "rule") return "Rule";
  if (entry.kind === "alarm") return "Alarm";
  if (entry.kind !== "fault" || entry.source === "") return "";
  const words = entry.source.replaceAll("_", " ");
  return labels.get(entry.source) ?? words.charAt(0).toUpperCase() + words.slice(1);
}
