import { expect, test } from "vitest";
import type { Action, Condition, Graph, Signal } from "../../api/ruleTypes";
import { type Names, plainAction, plainCondition, titleOf } from "./plain";

const STATUS = "automatika_ros_sugar/msg/ComponentStatus";
const topic = (name: string, type: string, component = "") => ({ name, type, component });
const graph = {
  topics: [
    topic("controller/status", STATUS, "controller"),
    topic("scan", "sensor_msgs/msg/LaserScan"),
    topic("clicked_point", "geometry_msgs/msg/PointStamped"),
  ],
} as Graph;
const names: Names = {
  component: (name) => (name === "drive_manager" ? "Drive" : titleOf(name)),
  constant: () => null,
  graph,
};
const signal = (name: string, type: string, ...path: (string | number)[]): Signal => ({
  topic: name,
  type,
  path,
  aggregate: null,
  timeout: 1,
});
const status = (operator: "==" | "!=", value: number): Condition => ({
  kind: "compare",
  signal: signal("controller/status", STATUS, "status"),
  operator,
  value,
  tolerance: 0,
});
const near: Condition = {
  kind: "compare",
  signal: { ...signal("scan", "sensor_msgs/msg/LaserScan", "ranges"), aggregate: "min" },
  operator: "<",
  value: 0.3,
  tolerance: 0,
};
const silent: Condition = {
  kind: "absent",
  signal: signal("scan", "sensor_msgs/msg/LaserScan"),
  seconds: 3,
  from_start: true,
};
const clicked: Condition = {
  kind: "received",
  signal: signal("clicked_point", "geometry_msgs/msg/PointStamped"),
};
const said = (condition: Condition) => plainCondition(condition, names);
const not = (condition: Condition): Condition => ({ kind: "not", condition });

test("what a component says of itself is said by its name and in words, not by a number", () => {
  expect([status("==", 1), status("==", 3), status("!=", 0), status("==", 0)].map(said)).toEqual([
    "Controller finds no solution",
    "Controller lacks something that it needs",
    "Controller is not well",
    "Controller is well",
  ]);
});

test("a topic that people have a word for is called by it", () => {
  expect(said(near)).toBe("the nearest obstacle is less than 0.3 m");
  expect(said(silent)).toBe("the laser scan is silent for 3 s");
  expect(said(clicked)).toBe("a message arrives on clicked point");
});

test("an opposite is said as one, and never as a bare not", () => {
  expect(said(not(near))).toBe("the nearest obstacle is at least 0.3 m");
  expect(said(not(silent))).toBe("the laser scan is not silent for 3 s");
  expect(said(not(status("==", 0)))).toBe("Controller is not well");
  expect(said(not(not(near)))).toBe(said(near));
  const both: Condition = {
    kind: "all",
    conditions: [near, not({ kind: "any", conditions: [silent, clicked] })],
  };
  expect(said(both)).toBe(
    "the nearest obstacle is less than 0.3 m and the laser scan is not silent for 3 s and no message arrives on clicked point",
  );
  expect(
    said({ kind: "any", conditions: [near, not({ kind: "any", conditions: [silent, clicked] })] }),
  ).toBe(
    "the nearest obstacle is less than 0.3 m or (the laser scan is not silent for 3 s and no message arrives on clicked point)",
  );
  expect(said(not({ kind: "all", conditions: [silent, clicked] }))).toBe(
    "the laser scan is not silent for 3 s or no message arrives on clicked point",
  );
});

test("what is done is said with the names of those who do it", () => {
  const common = { timeout: 10, on_error: "abort" } as const;
  const unblock: Action = {
    ...common,
    kind: "method",
    component: "drive_manager",
    method: "move_to_unblock",
    kwargs: {},
  };
  const stop: Action = {
    ...common,
    kind: "call_service",
    service: "stop",
    type: "kompass_interfaces/srv/StopRobot",
    request: {},
  };
  const set: Action = {
    ...common,
    kind: "update_parameters",
    component: "controller",
    parameters: { use_direct_sensor: true },
    keep_alive: true,
  };
  expect([unblock, stop, set].map((action) => plainAction(action, names))).toEqual([
    "Drive: move to unblock",
    "stop the robot",
    "set use direct sensor of Controller to true",
  ]);
});
