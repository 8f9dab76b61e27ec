import { expect, test } from "vitest";
import { consideredOf } from "./onMap";
import type { LocateDraft } from "./useLocateTool";

const here = { x: 1, y: 2, yaw: 0.5, agreement: 0.6 };
const best = { x: 1.1, y: 2.1, yaw: 0.4, agreement: 0.9 };
const check = { ok: true, message: "", here, best: null, note: "" };
const draft: LocateDraft = { anchor: null, phase: "checked", check, error: null };

test("what would be set is shown: the best place nearby, else the very one", () => {
  expect(consideredOf(draft)).toEqual({ mark: here, way: [], refused: null });
  const found = { ...draft, check: { ...check, best } };
  expect(consideredOf(found)).toEqual({ mark: best, way: [], refused: null });
});

test("what is no place is crossed out", () => {
  const wall = { ...draft, check: { ...check, ok: false } };
  expect(consideredOf(wall)).toEqual({ mark: null, way: [], refused: here });
});

test("nothing is shown before the answer, above the horizon, and of what was told", () => {
  expect(consideredOf(null)).toBeNull();
  expect(consideredOf({ ...draft, check: null })).toBeNull();
  expect(consideredOf({ ...draft, check: { ...check, ok: false, here: null } })).toBeNull();
  expect(consideredOf({ ...draft, phase: "told" })).toBeNull();
});
