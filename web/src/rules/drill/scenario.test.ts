import { expect, test } from "vitest";
import type { DrillFault, DrillPlace } from "../../api/drillTypes";
import {
  faultAt,
  goalAt,
  goalSentAt,
  inWords,
  inWorld,
  missing,
  newScenario,
  ofKind,
  outOfPlace,
  startAt,
  withoutFault,
  withoutGoal,
} from "./scenario";

const kind = (name: string, parameter: string, example: string, at_once = false): DrillFault => ({
  name,
  text: "",
  parameter,
  example,
  choices: [],
  at_once,
});
const blocked = { name: "way_blocked", at: 12, duration: 8 };

test("a scenario without a goal cannot be driven, and says what is missing", () => {
  const empty = newScenario("hexagon", "turtlebot3");
  expect(missing(empty)).toContain("press on the map");
  expect(missing(goalAt(empty, 0, { x: 1, y: 2 }))).toBe("");
});

test("a press adds a goal, a figure moves one, to the millimetre", () => {
  const one = goalAt(newScenario("hexagon", "turtlebot3"), 0, { x: 1.23456, y: 2 });
  const two = goalAt(one, 1, { x: -1, y: 0 });
  expect(two.goals.map(({ x, y }) => [x, y])).toEqual([
    [1.235, 2],
    [-1, 0],
  ]);
  expect(goalAt(two, 0, { x: 5, y: 5 }).goals).toHaveLength(2);
  expect(goalSentAt(two, 0, 8).goals.map(({ at }) => at)).toEqual([8, null]);
  expect(withoutGoal(two, 0).goals.map(({ x }) => x)).toEqual([-1]);
});

test("what a scenario of a file says beside places stays when a goal is moved", () => {
  const read = newScenario("hexagon", "turtlebot3");
  read.goals = [
    { x: 0, y: 0, yaw: 1, topic: null, tolerance: 0.2, heading_tolerance: null, at: 3 },
  ];
  expect(goalAt(read, 0, { x: 1, y: 1 }).goals[0]).toEqual({ ...read.goals[0], x: 1, y: 1 });
});

test("another kind of fault comes with what it needs, at the time of the one before", () => {
  expect(ofKind(blocked, kind("kill", "NAME", "mapper", true), ["controller"])).toEqual({
    name: "kill:controller",
    at: 12,
    duration: 0,
  });
  expect(ofKind(blocked, kind("glass", "SHARE", "0.3"), [])).toEqual({
    name: "glass:0.3",
    at: 12,
    duration: 8,
  });
});

test("faults are added, changed and taken away", () => {
  const two = faultAt(faultAt(newScenario("hexagon", "turtlebot3"), 0, blocked), 1, {
    ...blocked,
    at: 40,
  });
  expect(faultAt(two, 0, { ...blocked, at: 1 }).faults.map(({ at }) => at)).toEqual([1, 40]);
  expect(withoutFault(two, 0).faults.map(({ at }) => at)).toEqual([40]);
});

test("a goal in a pillar or beside the floor is told before it is driven", () => {
  const place: DrillPlace = {
    name: "room",
    title: "Room",
    bounds: [0, 0, 4, 4],
    start: [1, 1, 0],
    floor: [
      [0, 0],
      [4, 0],
      [4, 4],
      [0, 4],
    ],
    walls: [
      { x: 2, y: 2, yaw: 0, length: 1, width: 1, round: true },
      { x: 3, y: 1, yaw: Math.PI / 2, length: 1, width: 0.2, round: false },
    ],
    doorways: [],
  };
  const goals = (...spots: [number, number][]) =>
    spots.reduce(
      (made, [x, y], index) => goalAt(made, index, { x, y }),
      newScenario("room", "turtlebot3"),
    );
  expect(outOfPlace(goals([1, 1], [3.3, 1]), place)).toBe("");
  expect(outOfPlace(goals([1, 1], [2.2, 2]), place)).toContain("Goal 2 lies off the floor");
  expect(outOfPlace(goals([3, 1.4], [5, 1]), place)).toContain("Goals 1, 2 lie");
});

test("in another world there are none of the places of this one", () => {
  const here = startAt(goalAt(newScenario("hexagon", "turtlebot3"), 0, { x: 1, y: 1 }), {
    x: 0,
    y: 0,
    yaw: 0,
  });
  const there = inWorld(faultAt(here, 0, blocked), "warehouse");
  expect([there.start, there.goals, there.faults]).toEqual([null, [], [blocked]]);
  expect(inWorld(here, "hexagon")).toBe(here);
});

test("what the console has against a scenario names its parts as they stand on the page", () => {
  expect(inWords("The request cannot be read: scenario.faults.0: there is no fault 'x'.")).toBe(
    "The request cannot be read: fault 1: there is no fault 'x'.",
  );
  expect(inWords("scenario.goals.11.heading_tolerance: too large")).toBe(
    "goal 12, heading tolerance: too large",
  );
});
