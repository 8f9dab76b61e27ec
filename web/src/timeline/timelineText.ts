import type { TimelineEntry, TimelineKind, TimelineLevel } from "../api/types";
import { durationText } from "../format";
import { type Phrase, t } from "../texts/text";
import type { Level } from "../ui/StatusMark";

/** What happens, in the order of its lanes: what stops the robot first. */
export const KINDS: readonly { kind: TimelineKind; label: Phrase }[] = [
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

export function kindLabel(kind: TimelineKind): string {
  const known = KINDS.find((each) => each.kind === kind);
  return known === undefined ? kind : t(known.label);
}

/**
 * What stands behind the title: how long it lasted, or how often it came.
 *
 * @param now seconds since the epoch.
 */
export function lengthText(entry: TimelineEntry, now: number): string {
  const parts: string[] = [];
  if (entry.lasts)
    parts.push(
      t("for {duration} by now", { duration: durationText(Math.max(0, now - entry.time)) }),
    );
  else if (entry.ended === null) parts.push(t("end not seen"));
  else if (entry.count === 1 && entry.ended - entry.time >= 0.5)
    parts.push(durationText(entry.ended - entry.time));
  if (entry.count > 1) {
    const over = Math.max(entry.last, entry.ended ?? entry.time) - entry.time;
    parts.push(
      over >= 1
        ? t("{count} times in {duration}", { count: entry.count, duration: durationText(over) })
        : t("{count} times", { count: entry.count }),
    );
  }
  return parts.join(", ");
}

/** What an entry is about, before its title: a component's label, or that it is a rule. */
export function sourceText(entry: TimelineEntry, labels: ReadonlyMap<string, string>): string {
  if (entry.kind === "rule") return t("Rule");
  if (entry.kind === "alarm") return t("Alarm");
  if (entry.kind !== "fault" || entry.source === "") return "";
  const words = entry.source.replaceAll("_", " ");
  return labels.get(entry.source) ?? words.charAt(0).toUpperCase() + words.slice(1);
}
