import { expect, test } from "vitest";
import type { Component, State, Stream } from "../api/types";
import { componentLevel, overall, streamLevel } from "./overall";

const component = (part: Partial<Component> = {}): Component => ({
  name: "planner",
  label: "Planner",
  status: "healthy",
  message: "",
  sources: [],
  src_topics: [],
  src_components: [],
  src_algorithms: [],
  process: null,
  inputs: [],
  age: 0.1,
  topic: "/planner/status",
  ...part,
});
const stream = (part: Partial<Stream> = {}): Stream => ({
  key: "scan",
  label: "Laser scan",
  topic: "/scan",
  age: 0.1,
  deadline: 0.5,
  stale: false,
  ...part,
});
const state = (part: Partial<State> = {}): State => ({
  type: "state",
  seq: 1,
  time: 0,
  robot: { name: "robot", radius: 0.1 },
  pose: { x: 0, y: 0, yaw: 0, v: 0, w: 0, age: 0 },
  streams: [stream()],
  components: [component()],
  drive: null,
  goal: null,
  simulation: null,
  rules: {
    available: false,
    revision: 0,
    confirmed: 0,
    probation_left: 0,
    notice: "",
    alarms: 0,
    age: null,
  },
  processes: [],
  ros: { domain_id: 0, middleware: "" },
  viewers: 1,
  audit_problem: "",
  ...part,
});

test("all is well only when every component and stream is", () => {
  expect(overall(state(), 0.1)).toEqual({ level: "healthy", text: "All well" });
});

test("a stopped robot has no faults, but is not called well", () => {
  const drive = {
    available: true,
    stopped: true,
    standstill: true,
    stopped_by: "ava",
    reason: "",
    limited_by: "stop",
    driven_by: "",
    speed_factor: 0,
    age: 0,
  };
  expect(overall(state({ drive }), 0).text).toBe("No faults");
});

test("the worst component is named first", () => {
  const components = [
    component({ status: "algorithm_failure" }),
    component({ name: "mapper", label: "Mapper", status: "system_failure" }),
  ];
  expect(overall(state({ components }), 0)).toEqual({ level: "failed", text: "Mapper failed" });
});

test("several in the same state are counted", () => {
  const components = [component({ status: "silent" }), component({ name: "b", status: "silent" })];
  expect(overall(state({ components }), 0).text).toBe("2 components silent");
});

test("a component is unknown once its word is too old, even while no snapshot comes", () => {
  expect(componentLevel(component({ age: 0.2 }), 1)).toBe("healthy");
  expect(componentLevel(component({ age: 0.2 }), 2)).toBe("unknown");
});

test("a frozen view is never called well", () => {
  expect(overall(state(), 3)).toEqual({ level: "unknown", text: "No data for 3 s" });
  expect(overall(null, 0).level).toBe("unknown");
});

test("a robot without a position is not well", () => {
  expect(overall(state({ pose: null }), 0).text).toBe("Position unknown");
});

test("a late stream is named", () => {
  expect(overall(state({ streams: [stream({ age: 0.9, stale: true })] }), 0)).toEqual({
    level: "degraded",
    text: "Laser scan is late",
  });
});

test("a stream goes late between snapshots, one without a deadline does not", () => {
  expect(streamLevel(stream({ age: 0.1 }), 0.6)).toBe("degraded");
  expect(streamLevel(stream({ key: "map", age: 300, deadline: null }), 0.6)).toBe("healthy");
});

test("no path is the calm state of a robot without a goal, no map is not", () => {
  expect(streamLevel(stream({ key: "path", age: null, deadline: null, stale: false }), 0)).toBe(
    "healthy",
  );
  expect(streamLevel(stream({ key: "map", age: null, deadline: null, stale: true }), 0)).toBe(
    "unknown",
  );
});
