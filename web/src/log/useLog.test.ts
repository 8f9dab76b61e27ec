import { expect, test } from "vitest";
import type { LogLine, LogPage } from "../api/types";
import { hasCome, joined } from "./useLog";

const line = (number: number): LogLine => ({
  number,
  time: 0,
  level: "info",
  node: "planner",
  text: "",
  where: "",
  left_out: 0,
});
const page = (numbers: number[], newest: number, more = false): LogPage => ({
  lines: numbers.map(line),
  more,
  newest,
  nodes: [],
});
const shown = ({ lines }: LogPage) => lines.map(({ number }) => number);

test("what has come stands before what was known, up to so many lines", () => {
  const both = joined(page([2, 1], 2), page([4, 3], 4), 3);
  expect(shown(both)).toEqual([4, 3, 2]);
  expect(both.more).toBe(true);
});

test("where lines are missing between the two, what was known is not put behind a gap", () => {
  const both = joined(page([2, 1], 2), page([9, 8], 9, true), 10);
  expect(shown(both)).toEqual([9, 8]);
  expect(both.more).toBe(true);
});

test("the log of a console that was started again takes the place of the one before", () => {
  expect(shown(joined(page([90, 89], 90), page([1], 1), 10))).toEqual([1]);
});

test("who wants warnings asks when there is one, and not for every line", () => {
  const log = { available: true, newest: 9, newest_warning: 4 };
  expect(hasCome(log, { level: "warning", node: "", text: "" }, page([4], 4))).toBe(false);
  expect(hasCome(log, { level: "warning", node: "", text: "" }, page([3], 3))).toBe(true);
  expect(hasCome(log, { level: "info", node: "", text: "" }, page([4], 4))).toBe(true);
  expect(hasCome(log, { level: "info", node: "", text: "" }, page([9], 9))).toBe(false);
});

test("the log of a console that was started again is asked for, warnings or not", () => {
  const log = { available: true, newest: 2, newest_warning: 0 };
  expect(hasCome(log, { level: "warning", node: "", text: "" }, page([90], 90))).toBe(true);
});
