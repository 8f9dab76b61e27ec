import { beforeEach, expect, test } from "vitest";
import type { Rule, Table } from "../../api/ruleTypes";
import { defaultSide, differences, fieldSides, isMade, rebase } from "./conflict";
import {
  beginDraft,
  changesOf,
  discardRule,
  duplicateRule,
  freeId,
  isEmpty,
  keepDraft,
  keptDraft,
  moveRule,
  newRule,
  putRule,
  removeRule,
  settle,
} from "./draft";
import { incomplete, sendable } from "./findings";

function rule(id: string, part: Partial<Rule> = {}): Rule {
  const base = newRule({ rules: [] });
  return {
    ...base,
    id,
    name: id,
    source: "recipe",
    event: {
      ...base.event,
      condition: {
        kind: "received",
        signal: { topic: id, type: "std_msgs/msg/Bool", path: [], aggregate: null, timeout: 1 },
      },
    },
    actions: [{ kind: "log", text: id, level: "info", timeout: 10, on_error: "abort" }],
    ...part,
  };
}
const cooled = (of: Rule, cooldown: number): Rule => ({ ...of, event: { ...of.event, cooldown } });
const a = rule("a");
const b = rule("b");
const c = rule("c");
const base: Table = { rules: [a, b, c] };
const ids = (table: Table) => table.rules.map(({ id }) => id);

beforeEach(() => window.localStorage.clear());

test("a draft tells what was done in the words of the settings", () => {
  const draft = { ...beginDraft("robot", 3, base), table: putRule(base, cooled(b, 60)) };
  expect(changesOf(draft)).toMatchObject([
    { rule_id: "b", kind: "changed", semantic: true, summary: "cooldown 10 s → 60 s" },
  ]);
  expect(changesOf(draft)[0]?.fields).toEqual([{ field: "event.cooldown", before: 10, after: 60 }]);
  expect(isEmpty({ ...draft, table: putRule(draft.table, b) })).toBe(true);
});

test("each change can be taken back alone, a removed rule to its place", () => {
  const edited = removeRule(putRule(putRule(base, cooled(a, 1)), rule("d")), "b");
  const draft = { ...beginDraft("robot", 3, base), table: edited };
  expect(changesOf(draft).map((change) => change.kind)).toEqual(["changed", "added", "removed"]);
  const back = discardRule(discardRule(draft, "b"), "d");
  expect(ids(back.table)).toEqual(["a", "b", "c"]);
  expect(changesOf(back).map((change) => change.rule_id)).toEqual(["a"]);
});

test("moving one rule is one change", () => {
  const draft = { ...beginDraft("robot", 3, base), table: moveRule(base, "c", -2) };
  expect(ids(draft.table)).toEqual(["c", "a", "b"]);
  expect(changesOf(draft)).toMatchObject([{ rule_id: "c", kind: "moved", semantic: false }]);
});

test("a copy is another rule, switched off and behind its original", () => {
  const { table, id } = duplicateRule({ rules: [{ ...a, protected: true }, b] }, "a");
  expect(ids(table)).toEqual(["a", id, "b"]);
  expect(table.rules[1]).toMatchObject({ enabled: false, protected: false, name: "a (copy)" });
});

test("ids are made from names and never taken twice", () => {
  expect(freeId(base, "Näher als 0,3 m → anhalten!")).toBe("naher-als-0-3-m-anhalten");
  expect(freeId(base, "A")).toBe("a-2");
  expect(freeId(base, "→")).toBe("rule");
});

test("a draft outlives the page, for its own robot only", () => {
  const draft = { ...beginDraft("left", 3, base), table: putRule(base, cooled(a, 7)) };
  keepDraft(window.localStorage, "left", draft);
  expect(keptDraft(window.localStorage, "left")).toEqual(draft);
  expect(keptDraft(window.localStorage, "right")).toBeNull();
  window.localStorage.setItem("kompass.rules.draft.left", '{"base": 3');
  expect(keptDraft(window.localStorage, "left")).toBeNull();
});

test("a draft that is in force is over, one whose base came back goes on", () => {
  const draft = { ...beginDraft("robot", 3, base), table: putRule(base, cooled(a, 7)) };
  expect(settle(draft, draft.table, 4)).toBeNull();
  expect(settle(draft, base, 3)).toBe(draft);
  expect(settle(draft, base, 5)).toMatchObject({ base: 5, table: draft.table });
  const other: Table = { rules: [a, b] };
  expect(settle(draft, other, 4)).toBe(draft);
});

test("what somebody else did stays, what I did stays, and both only by choice", () => {
  const theirs: Table = { rules: [cooled(a, 1), b, rule("x")] };
  const mine: Table = { rules: [cooled(a, 2), rule("d"), cooled(b, 3), c] };
  const found = differences(base, theirs, mine);
  expect(found.filter(({ both }) => both).map(({ id }) => id)).toEqual(["a"]);
  expect(found.map((each) => [each.id, defaultSide(each)])).toEqual([
    ["a", "mine"],
    ["d", "mine"],
    ["b", "mine"],
    ["x", "theirs"],
    ["c", "theirs"],
  ]);
  const merged = rebase(base, theirs, mine, { a: "theirs" });
  expect(ids(merged)).toEqual(["a", "d", "b", "x"]);
  expect(merged.rules[0]?.event.cooldown).toBe(1);
  expect(merged.rules[2]?.event.cooldown).toBe(3);
  expect(rebase(base, theirs, mine, { a: "mine", d: "theirs" }).rules[0]?.event.cooldown).toBe(2);
});

test("the same change by both is no conflict", () => {
  const same: Table = { rules: [cooled(a, 1), b, c] };
  expect(differences(base, same, { rules: [cooled(a, 1), b, c] })[0]?.both).toBe(false);
});

test("a rule that I changed and they removed is mine again when I keep it", () => {
  const theirs: Table = { rules: [a, c] };
  const mine: Table = { rules: [a, cooled(b, 3), c] };
  expect(differences(base, theirs, mine)).toMatchObject([{ id: "b", both: true }]);
  expect(ids(rebase(base, theirs, mine, {}))).toEqual(["a", "b", "c"]);
  expect(ids(rebase(base, theirs, mine, { b: "theirs" }))).toEqual(["a", "c"]);
});

test("what a rule lacks is said at its field, and the robot is asked about the others", () => {
  const fresh = newRule(base);
  expect(incomplete(fresh).map(({ field }) => field)).toEqual([
    "event.condition.signal.topic",
    "actions",
  ]);
  const half: Table = { rules: [{ ...a, actions: [] }, cooled(b, 2), fresh] };
  expect(sendable(half, base)).toEqual({ rules: [a, cooled(b, 2)] });
  expect(incomplete(a)).toEqual([]);
});

test("of a rule that both changed, single fields are taken from either", () => {
  const theirs: Table = { rules: [{ ...cooled(a, 1), note: "theirs", name: "A" }, b, c] };
  const mine: Table = { rules: [{ ...cooled(a, 2), severity: "error", name: "A" }, b, c] };
  const [found] = differences(base, theirs, mine);
  if (found === undefined) throw new Error("no difference was found");
  expect(found.fields.map(({ field, by }) => [field.key, by])).toEqual([
    ["event.cooldown", "both"],
    ["severity", "mine"],
    ["note", "theirs"],
  ]);
  const sides = fieldSides(found);
  expect(isMade(found, sides)).toBe(false);
  const choice = { ...sides, "event.cooldown": "theirs" } as const;
  expect(isMade(found, choice)).toBe(true);
  expect(rebase(base, theirs, mine, { a: choice }).rules[0]).toMatchObject({
    name: "A",
    note: "theirs",
    severity: "error",
    event: { cooldown: 1 },
  });
});
