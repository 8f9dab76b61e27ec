import { afterEach, expect, test } from "vitest";
import type { Mission } from "../api/types";
import { beginning, dropDraft, keepDraft, keptDraft } from "./missionDraft";

const round = {
  id: 3,
  name: "Round",
  waypoints: [{ place: 1, tasks: [] }],
  rounds: 1,
  attempts: 1,
  on_failure: "pause",
  schedule: null,
} as unknown as Mission;

afterEach(() => localStorage.clear());

test.each([[null], [round]])("what was typed is kept until it is saved or left", (mission) => {
  const typed = { ...beginning(mission), name: "Night round" };
  keepDraft(mission, typed);
  expect(keptDraft(mission)).toEqual(typed);
  dropDraft(mission);
  expect(keptDraft(mission)).toBeNull();
});

test("what was taken back to how it began is nothing to keep", () => {
  keepDraft(round, { ...beginning(round), name: "Night round" });
  keepDraft(round, beginning(round));
  expect(keptDraft(round)).toBeNull();
});

test("a draft of a mission that somebody else has changed does not undo that", () => {
  keepDraft(round, { ...beginning(round), name: "Night round" });
  expect(keptDraft({ ...round, rounds: 0 })).toBeNull();
});

test("each mission, and a new one, has a draft of its own", () => {
  keepDraft(round, { ...beginning(round), name: "Night round" });
  expect(keptDraft(null)).toBeNull();
  expect(keptDraft({ ...round, id: 4 })).toBeNull();
});

test.each(['{"from": 3', "7", '{"from": {}}'])("what cannot be read counts as none: %s", (text) => {
  localStorage.setItem("kompass.mission.3", text);
  expect(keptDraft(round)).toBeNull();
});
