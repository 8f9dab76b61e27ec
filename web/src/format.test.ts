import { expect, test } from "vitest";
import {
  ageText,
  bytesText,
  degreesText,
  distanceText,
  durationText,
  hertzText,
  percentText,
  signed,
  wholeAgeText,
} from "./format";

test("an age shows a decimal only while it tells something", () => {
  expect([0, 0.24, 9.94, 9.96, 59.9, 61, 7300].map(ageText)).toEqual([
    "0.0 s",
    "0.2 s",
    "9.9 s",
    "9 s",
    "59 s",
    "1 min",
    "2 h",
  ]);
});

test("a sentence never says that something is zero seconds old", () => {
  expect(wholeAgeText(0.2)).toBe("1 s");
  expect(wholeAgeText(2.6)).toBe("3 s");
  expect(wholeAgeText(125)).toBe("2 min");
});

test("a distance is in centimetres below a metre and in metres above", () => {
  expect([0.041, 0.994, 0.996, 4.23, 120.4].map(distanceText)).toEqual([
    "4 cm",
    "99 cm",
    "1.0 m",
    "4.2 m",
    "120 m",
  ]);
});

test("a duration rounds to seconds and leaves out a rest of zero", () => {
  expect([20.6, 60, 125.2].map(durationText)).toEqual(["21 s", "1 min", "2 min 5 s"]);
});

test("a heading stays within half a turn of east", () => {
  expect(degreesText(Math.PI / 2)).toBe("90°");
  expect(degreesText(-Math.PI / 2)).toBe("−90°");
  expect(degreesText(1.5 * Math.PI)).toBe("−90°");
  expect(degreesText(Math.PI)).toBe("180°");
  expect(degreesText(-Math.PI)).toBe("180°");
});

test("there is no negative zero", () => {
  expect(signed(-0.001, 2)).toBe("0.00");
  expect(signed(-0.51, 2)).toBe("−0.51");
});

test("sizes of files are told in the unit that fits", () => {
  expect([0, 870_000, 4_200_000, 41_700_000, 1_300_000_000].map(bytesText)).toEqual([
    "0 kB",
    "870 kB",
    "4.2 MB",
    "42 MB",
    "1.3 GB",
  ]);
});

test("rates and shares have a decimal only where it tells something", () => {
  expect([0, 4.96, 9.96, 50].map(hertzText)).toEqual(["0.0 Hz", "5.0 Hz", "10 Hz", "50 Hz"]);
  expect([0.004, 0.12, 1.5].map(percentText)).toEqual(["0.4 %", "12 %", "150 %"]);
});
