/** A rule in the words of the table, with the robot's names for its numbers. */
import type { Graph, Literal, Rule, Signal } from "../../api/ruleTypes";
import { actionText } from "./actions";
import { type ConstantName, conditionText } from "./condition";
import { type Names, plainAction, plainCondition } from "./plain";
import { constantText, secondsText, TRIGGER_WORDS } from "./words";

export interface RuleLines {
  when: string;
  does: string;
  /** Both as people say them. */
  plain: { when: string; does: string };
  /** Holds, cooldowns and the like, each in a few words. */
  timing: string[];
}

/** What a message type calls the numbers of a field: 1 of a status is "ALGORITHM failure". */
export function constantNames(graph: Graph | null): ConstantName {
  const known = new Map<string, Map<number, string>>();
  for (const [type, fields] of Object.entries(graph?.types ?? {})) {
    for (const field of fields) {
      const entries = Object.entries(field.constants);
      if (entries.length === 0) continue;
      known.set(
        `${type} ${field.path.join(".")}`,
        new Map(entries.map(([name, n]) => [n, constantText(name, String(field.path.at(-1)))])),
      );
    }
  }
  return (signal: Signal, literal: Literal) =>
    typeof literal === "number" && signal.aggregate === null
      ? (known.get(`${signal.type} ${signal.path.join(".")}`)?.get(literal) ?? null)
      : null;
}

export function ruleLines(rule: Rule, called: Names): RuleLines {
  const names = called.constant;
  const { event } = rule;
  const timing: string[] = [];
  if (event.hold > 0) timing.push(`for ${secondsText(event.hold)}`);
  if (event.trigger !== "level") timing.push(TRIGGER_WORDS[event.trigger]);
  if (event.cooldown > 0) timing.push(`cooldown ${secondsText(event.cooldown)}`);
  if (event.once) timing.push("once");
  if (event.clear !== null) timing.push(`again after ${conditionText(event.clear, names)}`);
  if (event.max_rate !== null) {
    timing.push(`at most ${event.max_rate.count} in ${secondsText(event.max_rate.window)}`);
  }
  return {
    when: conditionText(event.condition, names),
    does: rule.actions.map(actionText).join(", then ") || "nothing yet",
    plain: {
      when: plainCondition(event.condition, called),
      does: rule.actions.map((each) => plainAction(each, called)).join(", then ") || "nothing yet",
    },
    timing,
  };
}

/** A whole rule in one sentence, as people say it and as the robot words it. */
export function wholeRule(rule: Rule, called: Names): { plain: string; expert: string } {
  const { when, does, plain } = ruleLines(rule, called);
  const hold = rule.event.hold > 0 ? ` for ${secondsText(rule.event.hold)}` : "";
  return {
    plain: `when ${plain.when}${hold}, then ${plain.does}`,
    expert: `when ${when}${hold}, then ${does}`,
  };
}
