import { expect, test } from "vitest";
import type { Cause } from "./causes";
import { component, DRIVE, robot, stream } from "./fixtures";
import { componentLevel, overall, streamLevel } from "./overall";

test("all is well only when every component and stream is", () => {
  expect(overall(robot(), 0.1, null)).toEqual({ level: "healthy", text: "All well" });
});

test("a stopped robot has no faults, but is not called well", () => {
  const drive = { ...DRIVE, stopped: true, stopped_by: "ava", limited_by: "stop", speed_factor: 0 };
  expect(overall(robot({ drive }), 0, null).text).toBe("No faults");
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
  const components = [component("planner", "Planner", { status: "system_failure" })];
  expect(overall(robot({ components }), 0, cause)).toEqual({
    level: "failed",
    text: "Laser scan lost",
  });
  expect(overall(robot({ components }), 0, { ...cause, others: 2 }).text).toBe(
    "Laser scan lost, and 2 more",
  );
});

test("components that blame each other are counted, for none of them is the cause", () => {
  const components = [
    component("planner", "Planner", { status: "system_failure" }),
    component("b", "B", { status: "system_failure" }),
  ];
  expect(overall(robot({ components }), 0, null).text).toBe("2 components failed");
});

test("a restart is told while all is well again", () => {
  expect(overall(robot(), 0, null, "Planner restarted 12 s ago")).toEqual({
    level: "healthy",
    text: "All well · Planner restarted 12 s ago",
  });
});

test("a component is unknown once its word is too old, even while no snapshot comes", () => {
  expect(componentLevel(component("planner", "Planner", { age: 0.2 }), 1)).toBe("healthy");
  expect(componentLevel(component("planner", "Planner", { age: 0.2 }), 2)).toBe("unknown");
});

test("a frozen view is never called well", () => {
  expect(overall(robot(), 3, null)).toEqual({ level: "unknown", text: "No data for 3 s" });
  expect(overall(null, 0, null).level).toBe("unknown");
});

test("a robot without a position is not well", () => {
  expect(overall(robot({ pose: null }), 0, null).text).toBe("Position unknown");
});

test("a stream goes late between snapshots, one without a deadline does not", () => {
  expect(streamLevel(stream("scan", "Laser scan", "/scan", { deadline: 0.5 }), 0.6)).toBe(
    "degraded",
  );
  expect(streamLevel(stream("map", "Map", "/map", { age: 300, deadline: null }), 0.6)).toBe(
    "healthy",
  );
});

test("no path is the calm state of a robot without a goal, no map is not", () => {
  expect(
    streamLevel(stream("path", "Path", "/path", { age: null, deadline: null, stale: false }), 0),
  ).toBe("healthy");
  expect(
    streamLevel(stream("map", "Map", "/map", { age: null, deadline: null, stale: true }), 0),
  ).toBe("unknown");
});

test("a robot whose rules have fallen silent is not well, one that never had any is", () => {
  const rules = { ...robot().rules, available: false, age: 4 };
  expect(overall(robot({ rules }), 1, null)).toEqual({
    level: "degraded",
    text: "Rules silent for 5 s",
  });
  expect(overall(robot({ rules: { ...rules, age: null } }), 0, null).level).toBe("healthy");
});

test("an alarm that stands, or a low battery, is not all well", () => {
  const rules = { ...robot().rules, alarms: 1 };
  expect(overall(robot({ rules }), 0, null)).toEqual({ level: "degraded", text: "One alarm" });
  const battery = {
    charge: 0.12,
    charging: false,
    low: true,
    voltage: null,
    topic: "/battery_state",
    age: 1,
  };
  expect(overall(robot({ battery }), 0, null)).toEqual({ level: "degraded", text: "Battery low" });
  const charged = { ...battery, charging: true };
  expect(overall(robot({ battery: charged }), 0, null).level).toBe("healthy");
});
