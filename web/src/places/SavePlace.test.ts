import { expect, test } from "vitest";
import type { GoalCheck } from "../api/types";
import { outOfReach } from "./SavePlace";

const check = (part: Partial<GoalCheck>) => part as GoalCheck;

test("whoever saves a place is told when the robot could not be sent there, and where it could", () => {
  expect(outOfReach(check({ ok: true, message: "" }))).toBe("");
  const walled = { ok: false, message: "No free way leads to this point." };
  expect(outOfReach(check({ ...walled, nearest: { x: 1.234, y: -2 } }))).toBe(
    "The robot could not be sent here now: No free way leads to this point. " +
      "The nearest point that it can get to is (1.23, -2.00).",
  );
  expect(outOfReach(check({ ...walled, nearest: null }))).toMatch(/this point\.$/);
});
