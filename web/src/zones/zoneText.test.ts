import { expect, test } from "vitest";
import {
  cornersText,
  drawn,
  labelText,
  readCorners,
  readSpeed,
  ruleText,
  shutInText,
} from "./zoneText";

test("a zone says what it asks for", () => {
  const slow = { name: "Aisle", kind: "speed", speed: 0.3 } as const;
  const barred = { name: "Stairs", kind: "keep_out", speed: null } as const;
  expect([ruleText(slow), ruleText(barred)]).toEqual(["At most 0.3 m/s", "Keep out"]);
  expect([labelText(slow), labelText(barred)]).toEqual(["Aisle: 0.3 m/s", "Stairs: keep out"]);
});

test("corners are typed as they are shown, and what is none is named by its line", () => {
  const corners = [
    [1, -0.5],
    [2.25, 3],
  ] as const;
  expect(readCorners(cornersText(corners))).toEqual({ corners, problem: null });
  expect(readCorners("1 2\n\n3;4").corners).toEqual([
    [1, 2],
    [3, 4],
  ]);
  expect(readCorners("1, 2\n3").problem).toContain("Line 2");
  expect(readCorners("1, two").problem).toContain("Line 1");
});

test("a speed is a number above 0", () => {
  expect(["0.3", "0,3", " 1 ", "", "0", "-1", "fast"].map(readSpeed)).toEqual([
    0.3,
    0.3,
    1,
    null,
    null,
    null,
    null,
  ]);
});

test("a press adds a corner; a drag makes a rectangle, and later one corner more", () => {
  expect(drawn([], [1, 1], null)).toEqual([[1, 1]]);
  expect(drawn([], [0, 0], [2, 1])).toEqual([
    [0, 0],
    [2, 0],
    [2, 1],
    [0, 1],
  ]);
  expect(drawn([[5, 5]], [0, 0], [2, 1])).toEqual([
    [5, 5],
    [2, 1],
  ]);
});

test("what a zone would shut in is told before it is saved", () => {
  expect(shutInText(false, [])).toBeNull();
  expect(shutInText(true, [])).toBe("The robot stands in it: then it is got out by hand only.");
  expect(shutInText(false, ["Gate"])).toBe("The place Gate lies in it.");
  expect(shutInText(true, ["Gate", "Dock", "Bay"])).toMatch(/Gate, Dock and Bay lie in it\.$/);
});
