import { expect, test } from "vitest";
import type { GoalCheck } from "../api/types";
import { consideredOf, pointOf } from "./onMap";

test("a tap is a goal without a heading, a drag one towards where it ends", () => {
  expect(pointOf([1, 2], null)).toEqual({ x: 1, y: 2, yaw: null });
  expect(pointOf([1, 2], [1, 3])).toEqual({ x: 1, y: 2, yaw: Math.PI / 2 });
  expect(pointOf([1, 2], [1.01, 2]).yaw).toBeNull();
});

const check: GoalCheck = {
  ok: true,
  x: 1,
  y: 2,
  yaw: 0.5,
  reason: "",
  message: "",
  nearest: null,
  length: 2,
  duration: 9,
  way: [0, 0, 1, 2],
  heading_used: true,
  note: "",
};

test("a goal is shown with the way to it", () => {
  expect(consideredOf(check)).toEqual({
    mark: { x: 1, y: 2, yaw: 0.5 },
    way: [0, 0, 1, 2],
    refused: null,
  });
});

test("of a refused goal the place is shown, and the nearest that can be reached", () => {
  const refused: GoalCheck = { ...check, ok: false, reason: "occupied", nearest: { x: 3, y: 4 } };
  expect(consideredOf(refused)).toEqual({
    mark: { x: 3, y: 4, yaw: 0.5 },
    way: [],
    refused: { x: 1, y: 2 },
  });
  expect(consideredOf({ ...refused, nearest: null })?.mark).toBeNull();
});

test("what is no place at all is not shown", () => {
  expect(consideredOf({ ...check, ok: false, reason: "above_horizon" })).toBeNull();
  expect(consideredOf(null)).toBeNull();
});
