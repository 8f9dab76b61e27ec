import { expect, test } from "vitest";
import { lengthText, measuredText, wholeLength } from "./measureText";

test("a length is told to the centimetre", () => {
  expect([0, 0.004, 0.42, 0.994, 0.996, 3.418, 99.99, 120.46].map(lengthText)).toEqual([
    "0 cm",
    "0 cm",
    "42 cm",
    "99 cm",
    "1.00 m",
    "3.42 m",
    "99.99 m",
    "120.5 m",
  ]);
});

test("there is nothing to tell before the second point", () => {
  expect(measuredText([])).toBeNull();
  expect(measuredText([[1, 2]])).toBeNull();
});

test("between two points it is the distance and which way the second lies", () => {
  expect(
    measuredText([
      [1, 1],
      [1, -2.5],
    ]),
  ).toBe("3.50 m, to −90°");
});

test("along more points it is the whole, the last of it, and the straight way", () => {
  const corner = [
    [0, 0],
    [3, 0],
    [3, 4],
  ] as const;
  expect(wholeLength(corner)).toBe(7);
  expect(measuredText(corner)).toBe(
    "7.00 m along 3 points · 4.00 m the last, to 90° · 5.00 m straight from the first",
  );
});
