/** Edits of the whole table that the robot has not seen yet. Nothing here changes its input. */
import type { Rule, RuleChange, Table } from "../../api/ruleTypes";
import { diffTables, sameRule } from "./diff";

export interface Draft {
  /** Of which robot's table; drafts of different robots never meet. */
  robot: string;
  /** The revision from which the edits began, and its table. */
  base: number;
  baseTable: Table;
  table: Table;
  reason: string;
}

export function beginDraft(robot: string, base: number, table: Table): Draft {
  return { robot, base, baseTable: table, table, reason: "" };
}

export const changesOf = (draft: Draft): RuleChange[] =>
  diffTables(draft.baseTable, draft.table).changes;

export const isEmpty = (draft: Draft): boolean => changesOf(draft).length === 0;

export function ruleOf(table: Table, id: string): Rule | null {
  return table.rules.find((rule) => rule.id === id) ?? null;
}

/** The table with a rule put in the place of the one with its id, or at the end. */
export function putRule(table: Table, rule: Rule): Table {
  const edited: Rule = { ...rule, source: "edited" };
  return table.rules.some(({ id }) => id === rule.id)
    ? { rules: table.rules.map((other) => (other.id === rule.id ? edited : other)) }
    : { rules: [...table.rules, edited] };
}

export function removeRule(table: Table, id: string): Table {
  return { rules: table.rules.filter((rule) => rule.id !== id) };
}

/** @param by places, negative is earlier. */
export function moveRule(table: Table, id: string, by: number): Table {
  const from = table.rules.findIndex((rule) => rule.id === id);
  const rule = table.rules[from];
  if (rule === undefined) return table;
  const rest = table.rules.filter((_, index) => index !== from);
  const to = Math.min(rest.length, Math.max(0, from + by));
  return { rules: [...rest.slice(0, to), rule, ...rest.slice(to)] };
}

/** A copy behind the original: a new rule, switched off until it is meant, and nobody's. */
export function duplicateRule(table: Table, id: string): { table: Table; id: string } {
  const index = table.rules.findIndex((rule) => rule.id === id);
  const rule = table.rules[index];
  if (rule === undefined) return { table, id };
  const name = `${rule.name || rule.id} (copy)`;
  const copy: Rule = {
    ...rule,
    id: freeId(table, name),
    name,
    enabled: false,
    protected: false,
    source: "edited",
  };
  const rules = [...table.rules];
  rules.splice(index + 1, 0, copy);
  return { table: { rules }, id: copy.id };
}

/** Takes back what was done to one rule: changed, added or removed. */
export function discardRule(draft: Draft, id: string): Draft {
  const was = ruleOf(draft.baseTable, id);
  if (was === null) return { ...draft, table: removeRule(draft.table, id) };
  if (ruleOf(draft.table, id) !== null) {
    return {
      ...draft,
      table: { rules: draft.table.rules.map((rule) => (rule.id === id ? was : rule)) },
    };
  }
  // Back behind the nearest of its former neighbours that is still there.
  const order = draft.baseTable.rules.map((rule) => rule.id);
  const before = new Set(order.slice(0, order.indexOf(id)));
  const rules = [...draft.table.rules];
  const at = rules.findLastIndex((rule) => before.has(rule.id)) + 1;
  rules.splice(at, 0, was);
  return { ...draft, table: { rules } };
}

/** A stable id from a name: lower case, dashes, and a number when it is taken. */
export function freeId(table: Table, name: string): string {
  const slug =
    name
      .normalize("NFKD")
      .replace(/\p{M}/gu, "")
      .toLowerCase()
      .replace(/[^a-z0-9]+/g, "-")
      .replace(/^-+|-+$/g, "")
      .slice(0, 80)
      .replace(/-+$/, "") || "rule";
  const taken = new Set(table.rules.map((rule) => rule.id));
  for (let number = 1; ; number++) {
    const id = number === 1 ? slug : `${slug}-${number}`;
    if (!taken.has(id)) return id;
  }
}

/** A rule to begin with: nothing chosen yet, and settings that do no harm. */
export function newRule(table: Table): Rule {
  return {
    id: freeId(table, "new rule"),
    name: "",
    enabled: true,
    event: {
      condition: {
        kind: "compare",
        signal: { topic: "", type: "", path: [], aggregate: null, timeout: 1 },
        operator: "==",
        value: 0,
        tolerance: 0,
      },
      trigger: "edge",
      hold: 0,
      clear: null,
      cooldown: 10,
      once: false,
      mode: { kind: "single" },
      max_rate: null,
      first_true_is_edge: true,
    },
    actions: [],
    severity: "warning",
    lane: "normal",
    protected: false,
    shadow: false,
    note: "",
    source: "edited",
  };
}

const key = (robot: string) => `kompass.rules.draft.${robot}`;

/** Keeps the draft in this browser; an empty one is forgotten. */
export function keepDraft(storage: Storage, robot: string, draft: Draft | null): void {
  if (draft === null) storage.removeItem(key(robot));
  else storage.setItem(key(robot), JSON.stringify(draft));
}

/** The draft that this browser keeps for a robot, or null; one that cannot be read counts as none. */
export function keptDraft(storage: Storage, robot: string): Draft | null {
  const text = storage.getItem(key(robot));
  if (text === null) return null;
  let found: unknown;
  try {
    found = JSON.parse(text);
  } catch {
    return null;
  }
  return isDraft(found) && found.robot === robot ? found : null;
}

function isDraft(value: unknown): value is Draft {
  if (typeof value !== "object" || value === null) return false;
  const { base, baseTable, table, robot, reason } = value as Record<string, unknown>;
  return (
    typeof base === "number" &&
    typeof robot === "string" &&
    typeof reason === "string" &&
    isTable(baseTable) &&
    isTable(table)
  );
}

function isTable(value: unknown): value is Table {
  return (
    typeof value === "object" &&
    value !== null &&
    Array.isArray((value as Record<string, unknown>).rules)
  );
}

/** The draft against the table now in force, once what it wanted is so; null then. */
export function settle(draft: Draft, inForce: Table, revision: number): Draft | null {
  if (draft.base === revision) return draft;
  if (sameTable(draft.table, inForce)) return null;
  return sameTable(draft.baseTable, inForce)
    ? { ...draft, base: revision, baseTable: inForce }
    : draft;
}

function sameTable(a: Table, b: Table): boolean {
  return (
    a.rules.length === b.rules.length &&
    a.rules.every((rule, index) => {
      const other = b.rules[index];
      return other !== undefined && rule.id === other.id && sameRule(rule, other);
    })
  );
}
