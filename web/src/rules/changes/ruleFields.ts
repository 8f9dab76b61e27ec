/** A rule taken apart into what a person can take from one version or from another. */
import type { Rule, RuleEvent } from "../../api/ruleTypes";
import { actionText } from "../model/actions";
import { conditionText } from "../model/condition";
import { secondsText } from "../model/words";
import { same } from "./diff";

export interface RuleField {
  key: string;
  label: string;
  read: (rule: Rule) => unknown;
  /** What `rule` has there, in words. */
  tell: (rule: Rule) => string;
  /** The rule with this field as it is in `other`. */
  take: (rule: Rule, other: Rule) => Rule;
}

const yesNo = (on: boolean): string => (on ? "yes" : "no");

function outer<K extends keyof Rule>(
  key: K,
  label: string,
  text: (value: Rule[K]) => string,
): RuleField {
  return {
    key,
    label,
    read: (rule) => rule[key],
    tell: (rule) => text(rule[key]),
    take: (rule, other) => ({ ...rule, [key]: other[key] }),
  };
}

function inner<K extends keyof RuleEvent>(
  key: K,
  label: string,
  text: (value: RuleEvent[K]) => string,
): RuleField {
  return {
    key: `event.${key}`,
    label,
    read: (rule) => rule.event[key],
    tell: (rule) => text(rule.event[key]),
    take: (rule, other) => ({ ...rule, event: { ...rule.event, [key]: other.event[key] } }),
  };
}

/** All that makes a rule, but its id and where it comes from; in the order of the form. */
const FIELDS: readonly RuleField[] = [
  outer("name", "Name", (name) => name || "none"),
  outer("enabled", "Switched on", yesNo),
  outer("shadow", "Shadow", yesNo),
  inner("condition", "When", (condition) => conditionText(condition)),
  inner("trigger", "Fires", String),
  inner("first_true_is_edge", "True from the start counts", yesNo),
  inner("hold", "Hold", secondsText),
  inner("clear", "Again after", (clear) => (clear === null ? "nothing" : conditionText(clear))),
  inner("cooldown", "Cooldown", secondsText),
  inner("once", "Once only", yesNo),
  inner("mode", "While running", (mode) => Object.values(mode).join(" ")),
  inner("max_rate", "At most", (limit) =>
    limit === null ? "no limit" : `${limit.count} in ${secondsText(limit.window)}`,
  ),
  outer("actions", "Then", (actions) => actions.map(actionText).join(", then ")),
  outer("severity", "Severity", String),
  outer("lane", "Lane", String),
  outer("protected", "Protected", yesNo),
  outer("note", "Note", (note) => note || "none"),
];

/** A field that two people changed to different things, or one of them alone. */
export interface FieldDifference {
  field: RuleField;
  by: "mine" | "theirs" | "both";
}

/** Where two versions differ, and whose doing it is; what both changed alike is no difference. */
export function fieldDifferences(base: Rule, theirs: Rule, mine: Rule): FieldDifference[] {
  return FIELDS.flatMap((field): FieldDifference[] => {
    if (same(field.read(mine), field.read(theirs))) return [];
    const my = !same(field.read(base), field.read(mine));
    const their = !same(field.read(base), field.read(theirs));
    return [{ field, by: my && their ? "both" : my ? "mine" : "theirs" }];
  });
}

/** Their version with some fields as they are in mine. */
export function mixed(theirs: Rule, mine: Rule, keys: ReadonlySet<string>): Rule {
  return FIELDS.filter(({ key }) => keys.has(key)).reduce((rule, field) => field.take(rule, mine), {
    ...theirs,
    source: "edited",
  } as Rule);
}
