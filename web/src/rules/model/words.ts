/** Times, states and kinds as an operator reads them. */

import type { Rule, RuleStatus, Trigger } from "../../api/ruleTypes";
import { fixed } from "../../format";
import * as dates from "../../texts/dates";
import type { Level } from "../../ui/StatusMark";

/** A duration as it was set: `30 s`, `0.25 s`, `3 min 20 s`. */
export function secondsText(seconds: number): string {
  if (seconds < 120 || !Number.isInteger(seconds)) return `${Number(seconds.toPrecision(6))} s`;
  const minutes = Math.floor(seconds / 60);
  const rest = seconds % 60;
  if (minutes < 120) return rest === 0 ? `${minutes} min` : `${minutes} min ${rest} s`;
  const left = minutes % 60;
  return left === 0 ? `${Math.floor(minutes / 60)} h` : `${Math.floor(minutes / 60)} h ${left} min`;
}

/** Time left or gone, for a display that counts: `1.2 s`, `41 s`, `3 min`. */
export function leftText(seconds: number): string {
  if (seconds < 9.95) return `${fixed(Math.max(0, seconds), 1)} s`;
  return seconds < 120 ? `${Math.round(seconds)} s` : secondsText(Math.round(seconds / 60) * 60);
}

/** As the rest of the page tells times; in English, as all of the rules' pages are. */
export const whenText = (time: number, now: number): string => dates.whenText(time, now, "en");
export const dayText = (time: number, newer: number): string | null =>
  dates.dayText(time, newer, "en");
export const clockText = (time: number): string => dates.clockText(time, "en");

/** Of a rule that fires once and has: since when, and what it takes. */
export function usedUpText({ last_fired }: RuleStatus, now: number): string {
  // A rule engine that was started again knows that it was used, and not when.
  if (last_fired === null) return "Used up; will not fire again until reset.";
  const part = now - last_fired < 12 * 3600 ? "minute" : "both";
  return `Used up at ${dates.dateText(last_fired, part, "en")}; will not fire again until reset.`;
}

export const ruleName = (rule: { id: string; name: string }): string => rule.name || rule.id;

/** Whether nothing but a message is waited for: silence is the normal state of such a rule. */
function awaitsMessage(status: RuleStatus, rule: Rule): boolean {
  return status.state === "unknown" && rule.event.condition.kind === "received";
}

/** How loud a rule's state is: calm while all is normal. */
export function statusLevel(status: RuleStatus | null, rule: Rule): Level {
  if (status === null) return "unknown";
  if (awaitsMessage(status, rule)) return status.last_ok === false ? "degraded" : "healthy";
  switch (status.state) {
    case "broken":
      return "failed";
    case "latched":
    case "used up":
      return "degraded";
    case "unknown":
    case "disabled":
    case "shadow":
      return "unknown";
    default:
      return status.last_ok === false ? "degraded" : "healthy";
  }
}

/** The state in a word or two, with its time: `cooling 41 s`, `holding 1.2/2 s`. */
export function statusText(status: RuleStatus | null, rule: Rule): string {
  if (status === null) return rule.enabled ? "not in force yet" : "disabled";
  const { state, left } = status;
  if (awaitsMessage(status, rule)) return "waits for a message";
  switch (state) {
    case "cooling":
      return left === null ? "cooling" : `cooling ${leftText(left)}`;
    case "holding": {
      if (left === null) return "holding";
      const hold = rule.event.hold;
      return `holding ${Math.max(0, hold - left).toFixed(1)}/${Number(hold.toPrecision(3))} s`;
    }
    case "unknown":
      return told(state, status.text);
    case "broken":
      return told(state, status.error || status.text);
    case "waiting":
      return "waits to re-arm";
    case "latched":
      return "latched: fired too often";
    case "ready":
    case "running":
    case "used up":
    case "disabled":
    case "shadow":
      return state;
  }
}

const told = (state: string, why: string): string => (why === "" ? state : `${state}: ${why}`);

export const TRIGGER_WORDS: Record<Trigger, string> = {
  level: "every message, while it is true",
  edge: "when it becomes true",
  change: "when a value changes, while it is true",
};

/** A constant of a message as a person says it: `STATUS_FAILURE_ALGORITHM` of `status`. */
export function constantText(name: string, field: string): string {
  const prefix = `${field.toUpperCase()}_`;
  return name
    .slice(name.toUpperCase().startsWith(prefix) ? prefix.length : 0)
    .toLowerCase()
    .replaceAll("_", " ");
}

export const SEVERITIES = ["info", "warning", "error", "critical"] as const;

/** How much of the flight recorder to take, by its seconds. */
export const STRETCHES = [
  { value: "60", label: "the last minute" },
  { value: "300", label: "the last 5 minutes" },
  { value: "600", label: "the last 10 minutes" },
  { value: "0", label: "all that is recorded" },
];

/** With a capital at its beginning and a stop at its end; nothing stays nothing. */
export function sentence(text: string): string {
  const begun = text.charAt(0).toUpperCase() + text.slice(1);
  return begun === "" || /[.!?…]$/.test(begun) ? begun : `${begun}.`;
}
