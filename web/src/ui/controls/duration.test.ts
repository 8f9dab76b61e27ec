import { expect, test } from "vitest";
import { durationFieldText, secondsOf } from "./duration";

test.each([
  ["90", 90],
  ["2.5 s", 2.5],
  ["2,5s", 2.5],
  [".5", 0.5],
  ["200 ms", 0.2],
  ["2 min", 120],
  ["2 Minutes", 120],
  ["1 min 30 s", 90],
  ["1h 30min", 5400],
  ["1.5 h", 5400],
  ["0", 0],
])("%s is a duration", (text, seconds) => {
  expect(secondsOf(text)).toBe(seconds);
});

test.each([
  "",
  "-5",
  "soon",
  "2 days",
  "1 min 30",
  "30 s 1 min",
  "1 s 2 s",
  "1e3",
  "5 5",
  "s",
  "2 min!",
])("%s is refused, and not taken for something near it", (text) => {
  expect(secondsOf(text)).toBeNull();
});

test("what a field shows reads back as the same", () => {
  for (const seconds of [0, 0.01, 0.2, 1 / 3, 45, 60, 77, 119, 120, 121, 150, 3600, 7200, 86400]) {
    expect(secondsOf(durationFieldText(seconds))).toBe(seconds);
  }
});
