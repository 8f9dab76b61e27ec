/** What differs between two tables, for changes that the robot has not seen yet. */
import type { FieldChange, Rule, RuleChange, Table, TableDiff } from "../../api/ruleTypes";
import { actionText } from "../model/actions";
import { conditionText } from "../model/condition";
import { secondsText } from "../model/words";

export function same(a: unknown, b: unknown): boolean {
  if (a === b) return true;
  if (typeof a !== "object" || typeof b !== "object" || a === null || b === null) return false;
  if (Array.isArray(a) !== Array.isArray(b)) return false;
  const keys = Object.keys(a);
  if (keys.length !== Object.keys(b).length) return false;
  return keys.every(
    (key) =>
      key in b && same((a as Record<string, unknown>)[key], (b as Record<string, unknown>)[key]),
  );
}

/** Whether two versions of a rule are the same; where it comes from is no difference. */
export const sameRule = (a: Rule, b: Rule): boolean =>
  same({ ...a, source: null }, { ...b, source: null });

export function diffTables(before: Table, after: Table): TableDiff {
  const old = new Map(before.rules.map((rule) => [rule.id, rule]));
  const changes: RuleChange[] = [];
  const order = after.rules.filter((rule) => old.has(rule.id)).map((rule) => rule.id);
  const oldOrder = before.rules.map((rule) => rule.id).filter((id) => order.includes(id));
  const moved = movedIds(oldOrder, order);
  for (const rule of after.rules) {
    const was = old.get(rule.id);
    if (was === undefined) {
      changes.push(change(rule, "added", `new: ${ruleText(rule)}`));
    } else if (!sameRule(was, rule)) {
      changes.push({
        ...change(rule, "changed", ruleChanges(was, rule).join("; ")),
        semantic: !sameRule({ ...was, name: "", note: "" }, { ...rule, name: "", note: "" }),
        fields: fieldChanges("", { ...was, source: null }, { ...rule, source: null }),
      });
    } else if (moved.has(rule.id)) {
      changes.push({ ...change(rule, "moved", "another place in the order"), semantic: false });
    }
  }
  const staying = new Set(after.rules.map((rule) => rule.id));
  for (const rule of before.rules) {
    if (!staying.has(rule.id)) changes.push(change(rule, "removed", `removed: ${ruleText(rule)}`));
  }
  return { before: null, after: null, changes };
}

function change(rule: Rule, kind: RuleChange["kind"], summary: string): RuleChange {
  return { rule_id: rule.id, name: rule.name, kind, semantic: true, summary, fields: [] };
}

/** The least ids that must move to get from one order of the same ids to the other. */
function movedIds(before: string[], after: string[]): Set<string> {
  const place = new Map(before.map((id, index) => [id, index]));
  const best: string[][] = [];
  for (const id of after) {
    const here = place.get(id) ?? 0;
    let longest: string[] = [];
    for (const run of best) {
      const last = run.at(-1);
      if (last !== undefined && (place.get(last) ?? 0) < here && run.length > longest.length) {
        longest = run;
      }
    }
    best.push([...longest, id]);
  }
  const stay = new Set(best.reduce<string[]>((a, b) => (b.length > a.length ? b : a), []));
  return new Set(after.filter((id) => !stay.has(id)));
}

function ruleText(rule: Rule): string {
  return `when ${conditionText(rule.event.condition)}, then ${rule.actions.map(actionText).join(", then ")}`;
}

/** Each difference as a few words: "cooldown 60 s → 20 s". */
function ruleChanges(was: Rule, rule: Rule): string[] {
  const said: string[] = [];
  const tell = (words: string, a: unknown, b: unknown, text: (v: never) => string) => {
    if (!same(a, b)) said.push(`${words} ${text(a as never)} → ${text(b as never)}`);
  };
  if (was.enabled !== rule.enabled) said.push(rule.enabled ? "switched on" : "switched off");
  if (was.shadow !== rule.shadow) {
    said.push(rule.shadow ? "in shadow: evaluated, does not act" : "acts again");
  }
  if (was.protected !== rule.protected) {
    said.push(rule.protected ? "protected" : "no longer protected");
  }
  tell("name", was.name, rule.name, (name: string) => `"${name}"`);
  tell("when", was.event.condition, rule.event.condition, conditionText);
  tell("trigger", was.event.trigger, rule.event.trigger, String);
  tell("hold", was.event.hold, rule.event.hold, secondsText);
  tell("cooldown", was.event.cooldown, rule.event.cooldown, secondsText);
  tell("clears when", was.event.clear, rule.event.clear, (clear: Rule["event"]["clear"]) =>
    clear === null ? "none" : conditionText(clear),
  );
  if (was.event.once !== rule.event.once)
    said.push(rule.event.once ? "once only" : "not only once");
  tell(
    "while running:",
    was.event.mode,
    rule.event.mode,
    (mode: Rule["event"]["mode"]) => mode.kind,
  );
  tell("limit", was.event.max_rate, rule.event.max_rate, (limit: Rule["event"]["max_rate"]) =>
    limit === null ? "none" : `${limit.count} in ${secondsText(limit.window)}`,
  );
  if (!same(was.actions, rule.actions)) {
    const texts = [was.actions, rule.actions].map((list) => list.map(actionText).join(", then "));
    said.push(texts[0] === texts[1] ? "details of the actions" : `then ${texts[0]} → ${texts[1]}`);
  }
  tell("severity", was.severity, rule.severity, String);
  tell("lane", was.lane, rule.lane, String);
  if (was.note !== rule.note) said.push("note changed");
  if (was.event.first_true_is_edge !== rule.event.first_true_is_edge) {
    said.push(
      `true from the start ${rule.event.first_true_is_edge ? "counts" : "does not count"} as becoming true`,
    );
  }
  return said;
}

function fieldChanges(at: string, before: unknown, after: unknown): FieldChange[] {
  if (same(before, after)) return [];
  if (isObject(before) && isObject(after) && before.kind === after.kind) {
    const keys = [...new Set([...Object.keys(before), ...Object.keys(after)])];
    return keys.flatMap((key) =>
      fieldChanges(at === "" ? key : `${at}.${key}`, before[key], after[key]),
    );
  }
  if (Array.isArray(before) && Array.isArray(after) && [...before, ...after].some(isObject)) {
    return Array.from({ length: Math.max(before.length, after.length) }).flatMap((_, index) =>
      fieldChanges(`${at}[${index}]`, before[index] ?? null, after[index] ?? null),
    );
  }
  return [{ field: at, before, after }];
}

function isObject(value: unknown): value is Record<string, unknown> {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}
