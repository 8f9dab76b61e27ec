import { expect, test } from "vitest";
import type { Component, Drive, State } from "../api/types";
import { lastRestart, rootCause, streamWord } from "./causes";
import { robot as anyRobot, component, DRIVE, stream } from "./fixtures";

type Process = NonNullable<Component["process"]>;

const process = (part: Partial<Process> = {}): Process => ({
  name: "planner",
  state: "active",
  pid: 7,
  restarts: 0,
  reason: "",
  restarted: null,
  cpu: 0.1,
  memory: 60_000_000,
  ...part,
});
const alive = (name: string, label: string, part: Partial<Component> = {}) =>
  component(name, label, { process: process({ name }), ...part });
const waits = (topic: string): Partial<Component> => ({
  status: "system_failure",
  message: `Failure: System Level - nothing on ${topic}`,
  src_topics: [topic],
});
const STREAMS = {
  odometry: stream("odometry", "Position", "/odometry/filtered", { deadline: 0.5 }),
  scan: stream("scan", "Laser scan", "/scan"),
  map: stream("map", "Map", "/map", { deadline: null, age: 300 }),
  local: stream("local_map", "Local map", "/local_map/occupancy_layer"),
};
const planner = alive("planner", "Planner", { outputs: ["/plan"] });
const controller = alive("controller", "Controller", { outputs: ["/control"] });
const mapper = alive("mapper", "Local map", { outputs: ["/local_map/occupancy_layer"] });
const gate = alive("drive_manager", "Drive");
const HELD: Drive = { ...DRIVE, limited_by: "scan stale", speed_factor: 0 };

const robot = (part: Partial<State> = {}) =>
  anyRobot({
    streams: Object.values(STREAMS),
    components: [planner, controller, mapper, gate],
    drive: DRIVE,
    ...part,
  });
const but = (part: Partial<typeof STREAMS>) => Object.values({ ...STREAMS, ...part });

test("a robot that is well has no cause of anything", () => {
  expect(rootCause(robot(), 0)).toBeNull();
});

test("a scan that was unplugged is the cause, and who waits for it or for whoever waits is told", () => {
  const state = robot({
    streams: but({
      scan: { ...STREAMS.scan, age: 34, stale: true },
      local: { ...STREAMS.local, age: 33.8, stale: true },
    }),
    components: [
      planner,
      { ...controller, ...waits("/local_map/occupancy_layer") },
      { ...mapper, ...waits("/scan") },
      { ...gate, ...waits("scan") },
    ],
    drive: HELD,
  });
  expect(rootCause(state, 0)).toMatchObject({
    level: "failed",
    name: "Laser scan lost",
    text: "Laser scan lost 34 s ago",
    effects: ["robot held", "Controller, local map and drive wait for it"],
    others: 0,
    minor: false,
  });
  expect(rootCause(state, 0)?.advice).toContain("/scan");
});

test("a second scanner that is silent is named, with who waits for it, though the first one speaks", () => {
  const state = robot({
    components: [
      planner,
      controller,
      { ...mapper, ...waits("/rear_scan") },
      { ...gate, ...waits("/rear_scan") },
    ],
    drive: HELD,
  });
  const cause = rootCause(state, 0);
  expect(cause?.text).toContain("gets nothing on /rear_scan");
  expect(cause?.advice).toBe("Check who publishes /rear_scan.");
  expect(cause?.effects).toContain("robot held");
});

test("what comes long after it was measured is named so, and not as unheard", () => {
  const old = "it comes 0.8 s after its stamp (a slow way, or clocks that differ)";
  const late = (told: string) => ({
    status: "system_failure" as const,
    message: `Failure: System Level - ${told} is too old: ${old}`,
    src_topics: ["/odometry/filtered"],
  });
  const state = robot({
    components: [
      planner,
      { ...controller, ...late("the location is unknown: what is on /odometry/filtered") },
      { ...mapper, ...late("what is on /odometry/filtered") },
      { ...gate, ...late("the odometry") },
    ],
    drive: HELD,
  });
  expect(rootCause(state, 0)).toMatchObject({
    name: "Position comes too late",
    text: `Position comes too late: ${old}`,
    effects: ["robot held", "Controller, local map and drive wait for it"],
    advice: "Check the network to the machine that sends it, and that machine's clock.",
    others: 0,
  });
});

test("a topic is late before it is lost, and counts on while no snapshot comes", () => {
  const late = { ...STREAMS.scan, age: 1.5, stale: true };
  expect(streamWord(late, 0)).toBe("late");
  expect(streamWord(late, 1.6)).toBe("lost");
  expect(streamWord({ ...STREAMS.map, age: 900 }, 0)).toBe("");
  expect(rootCause(robot({ streams: but({ scan: late }) }), 0)).toMatchObject({
    name: "Laser scan is late",
    minor: true,
  });
});

test("after the planner's restart the map, which is there, is not named as the cause", () => {
  const restarted = { ...planner, ...waits("/map"), process: process({ restarted: 3 }) };
  const cause = rootCause(robot({ components: [restarted, controller, mapper, gate] }), 0);
  expect(cause?.name).toBe("Planner is not ready");
  expect(cause?.text).toBe("Planner, restarted 3 s ago, has not heard the map yet");
  expect(cause?.advice).not.toContain("map server");
});

test("no map at all is the cause where the planner has none", () => {
  const state = robot({
    streams: but({ map: { ...STREAMS.map, age: null, stale: true } }),
    components: [{ ...planner, ...waits("/map") }, controller],
  });
  expect(rootCause(state, 0)).toMatchObject({
    text: "Map: nothing received yet",
    effects: ["Planner waits for it"],
    advice: "Load a map, or start the map server.",
  });
});

test("a map that nobody misses is no fault", () => {
  const streams = but({ map: { ...STREAMS.map, age: null, stale: true } });
  expect(rootCause(robot({ streams }), 0)).toBeNull();
});

test("a killed mapper is the cause, and not the local map that it does not send", () => {
  const dead = {
    ...mapper,
    status: "component_failure" as const,
    src_components: ["mapper"],
    process: process({ name: "mapper", state: "dead", reason: "killed by SIGKILL" }),
  };
  const state = robot({
    streams: but({ local: { ...STREAMS.local, age: 4, stale: true } }),
    components: [planner, { ...controller, ...waits("/local_map/occupancy_layer") }, dead, gate],
  });
  expect(rootCause(state, 0)).toMatchObject({
    text: "Local map died (killed by SIGKILL)",
    effects: ["Controller waits for it"],
    others: 0,
  });
});

test("a process that is no component, as a simulator, is the cause as well", () => {
  const dead = process({ name: "simulator", state: "dead" });
  const state = robot({
    streams: but({ scan: { ...STREAMS.scan, age: 5, stale: true } }),
    processes: [dead],
  });
  expect(rootCause(state, 0)?.text).toBe("Simulator died");
});

test("two things that have nothing to do with each other are counted", () => {
  const state = robot({
    streams: but({ scan: { ...STREAMS.scan, age: 9, stale: true } }),
    components: [
      { ...planner, status: "component_failure", message: "Failure: Component Level - No memory" },
      { ...mapper, ...waits("/scan") },
    ],
  });
  expect(rootCause(state, 0)).toMatchObject({ name: "Laser scan lost", others: 1 });
});

test("a topic that the console does not read is named as the component names it", () => {
  const state = robot({ components: [{ ...planner, ...waits("/floor_plan") }] });
  expect(rootCause(state, 0)).toMatchObject({
    text: "Planner gets nothing on /floor_plan",
    advice: "Check who publishes /floor_plan.",
  });
});

test("a whole stack that is silent is one thing", () => {
  const components = [planner, controller, mapper].map((c) => ({ ...c, age: 8 }));
  expect(rootCause(robot({ components }), 0)).toMatchObject({
    level: "unknown",
    text: "Nothing heard of the robot's program for 8 s",
    others: 0,
  });
});

test("a controller that finds no solution says so in words, and it is no matter for a band", () => {
  const components = [{ ...controller, status: "algorithm_failure" as const }];
  expect(rootCause(robot({ components }), 0)).toMatchObject({
    level: "degraded",
    name: "Controller finds no solution",
    minor: true,
  });
});

test("who was killed and started again is told afterwards, and not for ever", () => {
  const restarted = (ago: number | null) =>
    robot({ components: [{ ...planner, process: process({ restarts: 1, restarted: ago }) }] });
  expect(lastRestart(restarted(12))).toBe("Planner restarted 12 s ago");
  expect(lastRestart(restarted(90))).toBeNull();
  expect(lastRestart(restarted(null))).toBeNull();
});

test("a view without news tells of no cause: it does not know", () => {
  const state = robot({ streams: but({ scan: { ...STREAMS.scan, age: 9, stale: true } }) });
  expect(rootCause(state, 3)).toBeNull();
  expect(rootCause(null, 0)).toBeNull();
});

const LOST = { agreement: 0.31, lost: true, problem: null, age: 0.1 };

test("a robot that may be elsewhere is the cause of finding no way, before what is only late", () => {
  const stuck = { ...planner, status: "algorithm_failure" as const, message: "no path" };
  const cause = rootCause(
    robot({ localisation: LOST, components: [stuck, controller, mapper, gate] }),
    0,
  );
  expect(cause).toMatchObject({
    level: "degraded",
    name: "Place doubtful",
    text: "Scan and map agree 31 %",
    minor: false,
    others: 0,
  });
  expect(cause?.advice).toContain("Set its place");
});

test("without a scan nothing is said of the place, and the scan is the cause", () => {
  const scan = { ...STREAMS.scan, age: 9, stale: true };
  const silent = { agreement: null, lost: false, problem: "no_scan" as const, age: null };
  const cause = rootCause(
    robot({ localisation: silent, streams: [STREAMS.odometry, scan, STREAMS.map] }),
    0,
  );
  expect(cause?.name).toBe("Laser scan lost");
});

test("a robot of another stack is told of, too, when it may be elsewhere", () => {
  expect(rootCause(robot({ localisation: LOST, components: [] }), 0)?.name).toBe("Place doubtful");
  expect(rootCause(robot({ components: [] }), 0)).toBeNull();
});
