/** What is wrong with rules: seen here while they are written, and as the robot answers. */
import type { Action, Condition, Finding, Rule, Table } from "../../api/ruleTypes";
import { fieldOf, leavesOf } from "../model/condition";
import { ruleOf } from "./draft";

function missing(rule: Rule, field: string, text: string, remedy: string): Finding {
  return { level: "error", code: "incomplete", rule_id: rule.id, field, value: null, text, remedy };
}

/** What a rule still lacks before the robot can be asked about it. */
export function incomplete(rule: Rule): Finding[] {
  const { condition, clear } = rule.event;
  const found = [
    ...conditionGaps("event.condition", condition),
    ...(clear === null ? [] : conditionGaps("event.clear", clear)),
  ].map(([field, text, remedy]) => missing(rule, field, text, remedy));
  if (rule.actions.length === 0) {
    found.push(missing(rule, "actions", "The rule does nothing yet.", "Add what it shall do."));
  }
  rule.actions.forEach((action, index) => {
    const gap = actionGap(action);
    if (gap !== null) found.push(missing(rule, `actions[${index}]`, gap[0], gap[1]));
  });
  return found;
}

/** Whether a condition names a topic and a field wherever it needs one. */
export const isComplete = (condition: Condition): boolean =>
  conditionGaps("", condition).length === 0;

type Gap = [field: string, text: string, remedy: string];

function conditionGaps(root: string, condition: Condition): Gap[] {
  return leavesOf(condition).flatMap(({ path, leaf }): Gap[] => {
    const field = fieldOf(root, condition, path);
    const topic =
      leaf.kind === "callable" ? leaf.name : leaf.kind === "rate" ? leaf.topic : leaf.signal.topic;
    if (topic === "") {
      return [[`${field}.signal.topic`, "No topic is chosen.", "Choose what to watch."]];
    }
    if ((leaf.kind === "compare" || leaf.kind === "changed") && leaf.signal.path.length === 0) {
      return [[`${field}.signal.path`, "No field is chosen.", "Choose which value."]];
    }
    if (leaf.kind === "compare" && Array.isArray(leaf.value) && leaf.value.length === 0) {
      return [[`${field}.value`, "No value is given.", "Give at least one."]];
    }
    return [];
  });
}

/** What an action still lacks, and the remedy; null where nothing is missing. */
export function actionGap(action: Action): [string, string] | null {
  if (action.kind === "log" && action.text.trim() === "") {
    return ["The line is empty.", "Write what the log shall say."];
  }
  if ((action.kind === "raise_alarm" || action.kind === "clear_alarm") && action.alarm === "") {
    return ["The alarm has no name.", "Name it."];
  }
  if (action.kind === "start_mission" && action.mission === "") {
    return ["No mission is chosen.", "Choose which one."];
  }
  if (action.kind === "update_parameters" && Object.keys(action.parameters).length === 0) {
    return ["No parameter is chosen.", "Choose which one to set, and to what."];
  }
  return null;
}

/** The draft as it can be sent: rules that are not complete stay as they were, or away. */
export function sendable(draft: Table, base: Table): Table {
  return {
    rules: draft.rules.flatMap((rule) => {
      if (incomplete(rule).length === 0) return [rule];
      const was = ruleOf(base, rule.id);
      return was === null ? [] : [was];
    }),
  };
}

/** Findings that belong to a place of the form or to anything inside it. */
export function findingsAt(findings: readonly Finding[], field: string): Finding[] {
  return findings.filter(
    (finding) =>
      finding.field === field ||
      finding.field.startsWith(`${field}.`) ||
      finding.field.startsWith(`${field}[`),
  );
}

/** Findings that none of the given places shows. */
export function findingsElsewhere(findings: readonly Finding[], fields: string[]): Finding[] {
  const shown = new Set(fields.flatMap((field) => findingsAt(findings, field)));
  return findings.filter((finding) => !shown.has(finding));
}
