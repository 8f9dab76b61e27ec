import { expect, test } from "vitest";
import type { Drive } from "../../api/drillTypes";
import { going, lanes, marksOf, marksOnMap, played, Way } from "./playback";

const drive = (more: Partial<Drive> = {}): Drive => ({
  scenario: {
    name: "1-0",
    world: "hexagon",
    robot: "turtlebot3",
    seed: 1,
    start: { x: 0, y: 0, yaw: 1.5 },
    goals: [],
    faults: [],
    operators: [],
    limit: 60,
  },
  outcome: "recovered",
  left_stopped: false,
  why: "Recovered 4.0 s after way_blocked began.",
  duration: 20,
  recovery: 4,
  goals: [
    {
      x: 2,
      y: 2,
      tolerance: 0.1,
      sent: 2,
      ended: 18,
      outcome: "arrived",
      message: "",
      attempts: 1,
      superseded: false,
    },
  ],
  faults: [
    {
      name: "way_blocked",
      began: 5,
      ended: null,
      disturbed: true,
      causes: ["standing"],
      recovered_after: 4,
    },
  ],
  refused: [],
  firings: [],
  contacts: [],
  broken: [],
  unwell: [{ begin: 6, end: 9, causes: ["standing"] }],
  moments: [
    { at: 5, kind: "fault", text: "way_blocked began", x: 1, y: 0 },
    { at: 5, kind: "fault", text: "way_blocked began", x: 1, y: 0 },
    { at: 5.5, kind: "status", text: "planner failing", x: 1, y: 0 },
    { at: 7, kind: "firing", text: "stuck fired", x: 1, y: 0 },
  ],
  track: [
    [0, 0, 0],
    [4, 1, 0],
    [8, 1, 0],
    [10, 1, 2],
  ],
  ...more,
});

test("between two points of the way the robot is in between, and faces where it goes", () => {
  const way = new Way(drive());
  expect(way.at(2)).toEqual({ x: 0.5, y: 0, heading: 0 });
  expect(way.at(9)).toEqual({ x: 1, y: 1, heading: Math.PI / 2 });
});

test("it stands where it stood before and after, and keeps its heading while it stands", () => {
  const way = new Way(drive());
  expect(way.at(-1)).toEqual({ x: 0, y: 0, heading: 1.5 });
  expect(way.at(6)).toEqual({ x: 1, y: 0, heading: 0 });
  expect(way.at(99)).toEqual({ x: 1, y: 2, heading: Math.PI / 2 });
});

test("without a start of its own it faces where it goes first", () => {
  const { scenario } = drive();
  expect(new Way(drive({ scenario: { ...scenario, start: null } })).at(0)?.heading).toBe(0);
});

test("a drive that never was on the map has no place", () => {
  const way = new Way(drive({ track: [] }));
  expect(way.at(3)).toBeNull();
  expect(way.upTo(3)).toEqual([]);
});

test("the line that was driven ends where the robot is", () => {
  expect(new Way(drive()).upTo(5)).toEqual([
    { x: 0, y: 0 },
    { x: 1, y: 0 },
    { x: 1, y: 0 },
  ]);
});

test("a fault that never ends lasts to the end of the drive", () => {
  const fault = lanes(drive()).find(({ name }) => name === "fault");
  expect(fault?.stretches).toEqual([{ from: 5, to: 20, text: "way blocked" }]);
});

test("only what has a shape of its own is marked, and the same is marked once", () => {
  expect(marksOf(drive()).map(({ kind }) => kind)).toEqual(["fault", "firing"]);
});

test("marks of a kind that would lie over each other are one, on the map and on the time line", () => {
  const fired = (at: number, x: number) => ({
    at,
    kind: "firing" as const,
    text: "fired",
    x,
    y: 0,
  });
  const many = drive({ moments: [fired(1, 0), fired(1.1, 0.1), fired(1.4, 2), fired(9, 0)] });
  expect(marksOnMap(many, 20, 0.5).map(({ at }) => at)).toEqual([1, 1.4]);
  expect(marksOnMap(many, 1, 0.5).map(({ at }) => at)).toEqual([1]);
  const rules = lanes(many).find(({ name }) => name === "rules");
  expect(rules?.marks.map(({ at }) => at)).toEqual([1, 1.4, 9]);
  expect(marksOf(many)).toHaveLength(4);
});

test("what goes on is told for any moment, and at the end what became of it", () => {
  expect(going(drive(), 1)).toBe("no goal");
  expect(going(drive(), 3)).toBe("under way");
  expect(going(drive(), 7.5)).toBe("under way · way blocked on · standing · stuck fired");
  expect(going(drive(), 20)).toBe("Recovered 4.0 s after way blocked began.");
});

test("a STOP is seen from when it is pressed until somebody releases it, or to the end", () => {
  const stop = (at: number) => ({ at, kind: "stop" as const, text: "STOP by ava", x: 1, y: 0 });
  const release = { at: 6, kind: "release" as const, text: "STOP released by ava", x: 1, y: 0 };
  const stopped = drive({ unwell: [], moments: [stop(3), release, stop(12), stop(13)] });
  expect(lanes(stopped).find(({ name }) => name === "alert")?.stretches).toEqual([
    { from: 3, to: 6, text: "STOP by ava" },
    { from: 12, to: 20, text: "STOP by ava" },
  ]);
  expect(going(stopped, 4)).toBe("under way · STOP by ava");
  expect(going(stopped, 8)).toBe("under way · way blocked on");
  expect(going(stopped, 19)).toBe("no goal · way blocked on · STOP by ava");
});

test("it plays at its speed, and stops at the end", () => {
  expect(played(1, 500, 5, 20)).toBe(3.5);
  expect(played(19, 1000, 10, 20)).toBe(20);
});
