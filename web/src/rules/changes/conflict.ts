/** Two people changed the table: what each did, rule by rule, and how to go on from there. */
import type { Rule, RuleChange, Table } from "../../api/ruleTypes";
import { diffTables, sameRule } from "./diff";
import { ruleOf } from "./draft";
import { type FieldDifference, fieldDifferences, mixed } from "./ruleFields";

export type Side = "mine" | "theirs";
/** For a whole rule, or for each of its fields by its key. */
export type Choice = Side | Readonly<Record<string, Side>>;

export interface Difference {
  id: string;
  name: string;
  mine: RuleChange | null;
  theirs: RuleChange | null;
  /** Both changed it, and not to the same: a person must choose. */
  both: boolean;
  /** Where the two versions differ; empty when one of them is not there. */
  fields: FieldDifference[];
}

/** Every rule that either changed since `base`. */
export function differences(base: Table, theirs: Table, mine: Table): Difference[] {
  const yours = new Map(diffTables(base, mine).changes.map((change) => [change.rule_id, change]));
  const others = new Map(
    diffTables(base, theirs).changes.map((change) => [change.rule_id, change]),
  );
  return [...new Set([...yours.keys(), ...others.keys()])].map((id) => {
    const my = yours.get(id) ?? null;
    const their = others.get(id) ?? null;
    const [was, ours, now] = [base, mine, theirs].map((table) => ruleOf(table, id));
    return {
      id,
      name: my?.name || their?.name || id,
      mine: my,
      theirs: their,
      both:
        my !== null &&
        their !== null &&
        my.kind !== "moved" &&
        their.kind !== "moved" &&
        !alike(ruleOf(mine, id), ruleOf(theirs, id)),
      fields: was && ours && now ? fieldDifferences(was, now, ours) : [],
    };
  });
}

function alike(a: Rule | null, b: Rule | null): boolean {
  return a === null || b === null ? a === b : sameRule(a, b);
}

/** The side that a rule is on without anybody choosing: whoever changed it. */
export function defaultSide(difference: Difference): Side {
  return difference.mine !== null && difference.mine.kind !== "moved" ? "mine" : "theirs";
}

/** The sides of the fields that only one of the two changed; who changed both must choose. */
export function fieldSides(difference: Difference): Record<string, Side> {
  return Object.fromEntries(
    difference.fields.flatMap(({ field, by }) => (by === "both" ? [] : [[field.key, by]])),
  );
}

/** Whether a choice leaves nothing open. */
export function isMade(difference: Difference, choice: Choice | undefined): boolean {
  if (choice === undefined) return !difference.both;
  return typeof choice === "string" || difference.fields.every(({ field }) => field.key in choice);
}

/**
 * Their table with my changes laid over it, rule by rule as chosen.
 *
 * Rules that only I changed are mine, all others theirs unless chosen otherwise. Mine keep their
 * place behind the rule that they stood behind.
 */
export function rebase(
  base: Table,
  theirs: Table,
  mine: Table,
  chosen: Readonly<Record<string, Choice>>,
): Table {
  const sides = new Map<string, Choice>(
    differences(base, theirs, mine).map((difference) => [
      difference.id,
      chosen[difference.id] ?? defaultSide(difference),
    ]),
  );
  const rules: Rule[] = [];
  for (const rule of theirs.rules) {
    const my = ruleOf(mine, rule.id);
    const side = sides.get(rule.id) ?? "theirs";
    if (typeof side === "object" && my !== null) rules.push(mixed(rule, my, mineOf(side)));
    else if (side !== "mine") rules.push(rule);
    else if (my !== null) rules.push(my);
  }
  for (const [index, rule] of mine.rules.entries()) {
    if (sides.get(rule.id) !== "mine" || ruleOf(theirs, rule.id) !== null) continue;
    const before = mine.rules.slice(0, index).map(({ id }) => id);
    const at = rules.findLastIndex(({ id }) => before.includes(id)) + 1;
    rules.splice(index === 0 ? 0 : at === 0 ? rules.length : at, 0, rule);
  }
  return { rules };
}

const mineOf = (sides: Readonly<Record<string, Side>>): Set<string> =>
  new Set(Object.keys(sides).filter((key) => sides[key] === "mine"));
