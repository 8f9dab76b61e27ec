import { expect, test } from "vitest";
import type { Mission, MissionRun } from "../api/types";
import { missionProblem, missionText, progressText, runLine, tellsGoal } from "./missionText";

const run = (part: Partial<MissionRun> = {}): MissionRun => ({
  number: 1,
  mission: 1,
  name: "Round",
  by: "ava",
  phase: "driving",
  step: 1,
  elapsed: 0,
  round: 1,
  rounds: 1,
  waypoint: 2,
  waypoints: 5,
  attempt: 1,
  place: "Dock",
  task: "",
  ask: "",
  left: null,
  reason: "",
  decided_by: "",
  skipped: [],
  ...part,
});

test("a mission says what it does, for how long, and what a person is to do", () => {
  expect(runLine(run(), 0).text).toBe("Driving to Dock");
  expect(runLine(run({ phase: "waiting", left: 30 }), 10).text).toBe("Waiting at Dock, 20 s left");
  expect(runLine(run({ phase: "asking", ask: "Load it" }), 0)).toEqual({
    tone: "problem",
    text: "Waits for a person at Dock",
    more: "Load it",
  });
  expect(runLine(run({ phase: "paused", reason: "ava pressed STOP", decided_by: "" }), 0)).toEqual({
    tone: "problem",
    text: "Paused, next is Dock",
    more: "Ava pressed STOP.",
  });
  expect(runLine(run({ phase: "paused", decided_by: "ben" }), 0).text).toBe(
    "Paused by ben, next is Dock",
  );
  expect(runLine(run({ phase: "done", skipped: ["Gate: A wall."] }), 0).more).toBe(
    "Left out: Gate: A wall.",
  );
  expect(runLine(run({ place: "" }), 0).text).toBe("Driving to a place that is gone");
});

test("how far it is counts places, and rounds where there are several", () => {
  expect(progressText(run())).toBe("Place 2 of 5");
  expect(progressText(run({ round: 3, rounds: 10 }))).toBe("Place 2 of 5 · round 3 of 10");
  expect(progressText(run({ round: 3, rounds: 0 }))).toBe("Place 2 of 5 · round 3");
});

test("the goal of a mission is told of with it, and that of somebody else apart", () => {
  const its = "mission Round";
  expect(tellsGoal(null, its)).toBe(false);
  expect(tellsGoal(run(), its)).toBe(true);
  expect(tellsGoal(run({ phase: "paused" }), its)).toBe(true);
  expect(tellsGoal(run({ phase: "paused" }), "ava")).toBe(false);
  expect(tellsGoal(run({ phase: "done" }), its)).toBe(false);
});

test("a mission in the list says how much it is and when it begins", () => {
  const mission = (part: Partial<Mission>) =>
    missionText({
      waypoints: [{ place: 1 }, { place: 2 }],
      rounds: 1,
      schedule: null,
      ...part,
    } as Mission);
  expect(mission({})).toBe("2 places");
  expect(mission({ rounds: 0 })).toBe("2 places, round and round");
  const at = "08:00";
  expect(mission({ schedule: { at, days: [0, 1, 2, 3, 4, 5, 6] } })).toBe(
    "2 places, daily at 08:00",
  );
  expect(mission({ schedule: { at, days: [0, 1, 2, 3, 4] } })).toBe(
    "2 places, Mon to Fri at 08:00",
  );
  expect(mission({ schedule: { at, days: [5, 6] } })).toBe("2 places, Sat, Sun at 08:00");
});

test("what cannot be saved is said before it is sent", () => {
  const place = { id: 1, here: true } as Parameters<typeof missionProblem>[1][number];
  const waypoints = [{ place: 1, tasks: [] }];
  const base = { rounds: 1, attempts: 1, on_failure: "pause", schedule: null } as const;
  expect(missionProblem({ ...base, name: " ", waypoints }, [place])).toMatch(/name/);
  expect(missionProblem({ ...base, name: "R", waypoints: [] }, [place])).toMatch(/Add a place/);
  expect(missionProblem({ ...base, name: "R", waypoints }, [])).toMatch(/Place 1 is there no more/);
  const nameless = {
    kind: "act",
    action: { kind: "raise_alarm", alarm: "", text: "", on_error: "continue", timeout: null },
  } as const;
  const tasks = [{ kind: "stop" } as const, nameless];
  expect(missionProblem({ ...base, name: "R", waypoints: [{ place: 1, tasks }] }, [place])).toBe(
    "Place 1, task 2: The alarm has no name. Name it.",
  );
  const schedule = { at: "08:00", days: [] };
  expect(missionProblem({ ...base, name: "R", waypoints, schedule }, [place])).toMatch(/a day/);
  expect(missionProblem({ ...base, name: "R", waypoints }, [place])).toBeNull();
});
