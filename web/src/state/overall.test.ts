import { expect, test } from "vitest";
import type { Component, State, Stream } from "../api/types";
import type { Cause } from "./causes";
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
  outputs: [],
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
  robot: { name: "robot", radius: 0.1, problem: "" },
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
  expect(overall(state(), 0.1, null)).toEqual({ level: "healthy", text: "All well" });
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
  expect(overall(state({ drive }), 0, null).text).toBe("No faults");
});

test("what is behind all else is named, and how much else there is", () => {
  const cause: Cause = {
    level: "failed",
    name: "Laser scan lost",
    text: "Laser scan lost 34 s ago",
    effects: [],
    advice: "",
    others: 0,
    minor: false,
  };
  const components = [component({ status: "system_failure" })];
  expect(overall(state({ components }), 0, cause)).toEqual({
    level: "failed",
    text: "Laser scan lost",
  });
  expect(overall(state({ components }), 0, { ...cause, others: 2 }).text).toBe(
    "Laser scan lost, and 2 more",
  );
});

test("components that blame each other are counted, for none of them is the cause", () => {
  const components = [
    component({ status: "system_failure" }),
    component({ name: "b", status: "system_failure" }),
  ];
  expect(overall(state({ components }), 0, null).text).toBe("2 components failed");
});

test("a restart is told while all is well again", () => {
  expect(overall(state(), 0, null, "Planner restarted 12 s ago")).toEqual({
    level: "healthy",
    text: "All well · Planner restarted 12 s ago",
  });
});

test("a component is unknown once its word is too old, even while no snapshot comes", () => {
  expect(componentLevel(component({ age: 0.2 }), 1)).toBe("healthy");
  expect(componentLevel(component({ age: 0.2 }), 2)).toBe("unknown");
});

test("a frozen view is never called well", () => {
  expect(overall(state(), 3, null)).toEqual({ level: "unknown", text: "No data for 3 s" });
  expect(overall(null, 0, null).level).toBe("unknown");
});

test("a robot without a position is not well", () => {
  expect(overall(state({ pose: null }), 0, null).text).toBe("Position unknown");
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
