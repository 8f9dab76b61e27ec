/** Two people changed the table: what each did, rule by rule, and how to go on from there. */
import type { Rule, RuleChange, Table } from "../../api/ruleTypes";
import { diffTables, sameRule } from "./diff";
import { ruleOf } from "./draft";

export type Side = "mine" | "theirs";

export interface Difference {
  id: string;
  name: string;
  mine: RuleChange | null;
  theirs: RuleChange | null;
  /** Both changed it, and not to the same: a person must choose. */
  both: boolean;
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
  chosen: Readonly<Record<string, Side>>,
): Table {
  const sides = new Map(
    differences(base, theirs, mine).map((difference) => [
      difference.id,
      chosen[difference.id] ?? defaultSide(difference),
    ]),
  );
  const rules: Rule[] = [];
  for (const rule of theirs.rules) {
    const my = ruleOf(mine, rule.id);
    if (sides.get(rule.id) !== "mine") rules.push(rule);
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
