import { expect, test } from "vitest";
import { parseCoordinates } from "./coordinates";

test("typed coordinates become a goal, the heading in radians", () => {
  expect(parseCoordinates(" 1.5", "-2", "90").goal).toEqual({ x: 1.5, y: -2, yaw: Math.PI / 2 });
});

test("a decimal comma is understood and an empty heading means none", () => {
  expect(parseCoordinates("1,5", "0", " ").goal).toEqual({ x: 1.5, y: 0, yaw: null });
});

test("what is missing or no number is named at its field", () => {
  const { goal, errors } = parseCoordinates("", "north", "9o");
  expect(goal).toBeNull();
  expect(errors.x).toContain("Needed");
  expect(errors.y).toBe("Not a number: north");
  expect(errors.heading).toBe("Not a number: 9o");
});
