import { expect, test } from "vitest";
import type { Condition, Leaf } from "../../api/ruleTypes";
import {
  addAt,
  conditionText,
  fieldOf,
  leavesOf,
  nodeAt,
  removeAt,
  replaceAt,
  toggleNot,
} from "./condition";

const signal = (topic: string, ...path: (string | number)[]) => ({
  topic,
  type: "sensor_msgs/msg/LaserScan",
  path,
  aggregate: null,
  timeout: 1,
});
const near: Leaf = {
  kind: "compare",
  signal: { ...signal("scan", "ranges"), aggregate: "min" },
  operator: "<",
  value: 0.3,
  tolerance: 0,
};
const silent: Leaf = { kind: "absent", signal: signal("scan"), seconds: 3, from_start: true };
const clicked: Leaf = { kind: "received", signal: signal("clicked_point") };
const tree: Condition = {
  kind: "all",
  conditions: [near, { kind: "not", condition: { kind: "any", conditions: [silent, clicked] } }],
};

test("a condition reads as the robot words it", () => {
  expect(conditionText(tree)).toBe(
    "min(scan.ranges) < 0.3 and not (scan absent for 3 s or clicked_point received)",
  );
  expect(conditionText({ ...near, operator: "between", value: [0.1, 0.3] })).toBe(
    "0.1 <= min(scan.ranges) <= 0.3",
  );
  expect(
    conditionText({
      ...near,
      signal: signal("path", "poses", 0, "x"),
      operator: "not_in",
      value: ["a", "b"],
    }),
  ).toBe('path.poses[0].x not in ["a", "b"]');
});

test("leaves carry the paths by which the robot reports them", () => {
  expect(leavesOf(tree).map(({ path }) => path)).toEqual([[0], [1, 0, 0], [1, 0, 1]]);
  expect(leavesOf(near).map(({ path }) => path)).toEqual([[]]);
});

test("a node's place is named as findings name it", () => {
  expect(fieldOf("event.condition", tree, [1, 0, 1])).toBe(
    "event.condition.conditions[1].condition.conditions[1]",
  );
});

test("changing one node leaves the others and the original alone", () => {
  const before = JSON.stringify(tree);
  const next = replaceAt(tree, [1, 0, 0], near);
  expect(nodeAt(next, [1, 0, 0])).toEqual(near);
  expect(nodeAt(next, [0])).toBe(nodeAt(tree, [0]));
  expect(JSON.stringify(tree)).toBe(before);
});

test("a group that loses its last condition goes with it, and an empty tree is nothing", () => {
  const without = removeAt(tree, [1, 0, 0]);
  expect(without !== null && leavesOf(without).length).toBe(2);
  const left = without === null ? null : removeAt(without, [1, 0, 0]);
  expect(left).toEqual({ kind: "all", conditions: [near] });
  expect(left === null ? null : removeAt(left, [0])).toBeNull();
});

test("a second condition beside a single one makes a group of both", () => {
  expect(addAt(near, [], silent)).toEqual({ kind: "all", conditions: [near, silent] });
  expect(addAt(tree, [], clicked).kind).toBe("all");
});

test("not is taken on and off", () => {
  expect(toggleNot(near, [])).toEqual({ kind: "not", condition: near });
  expect(toggleNot(toggleNot(near, []), [])).toEqual(near);
});
