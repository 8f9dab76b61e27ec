// @vitest-environment jsdom
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { HandLoop, RENEW_MS } from "./handLoop";
import { isNothing, NOTHING, type Push, stickPush } from "./push";

let told: Push[];
let pad: Push;
let focused: boolean;
let loop: HandLoop;

beforeEach(() => {
  vi.useFakeTimers();
  told = [];
  pad = NOTHING;
  focused = true;
  vi.spyOn(document, "hasFocus").mockImplementation(() => focused);
  loop = new HandLoop(
    (push) => told.push(push),
    () => pad,
  );
  loop.start();
});

afterEach(() => {
  loop.stop();
  vi.useRealTimers();
  vi.restoreAllMocks();
});

const newest = () => told[told.length - 1];

test("what is held is told again and again, and what is not held is, too", () => {
  loop.key("KeyW", true);
  told.length = 0;
  vi.advanceTimersByTime(10 * RENEW_MS);
  expect(told.length).toBeGreaterThanOrEqual(9);
  expect(told.every((push) => push.ahead === 1)).toBe(true);
  loop.key("KeyW", false);
  told.length = 0;
  vi.advanceTimersByTime(5 * RENEW_MS);
  expect(told.length).toBeGreaterThanOrEqual(4);
  expect(told.every(isNothing)).toBe(true);
});

test("letting go of a key or of the stick is told at once", () => {
  loop.key("KeyW", true);
  loop.key("KeyW", false);
  expect(newest()).toEqual(NOTHING);
  loop.moveStick(stickPush(0, -1));
  vi.advanceTimersByTime(RENEW_MS);
  expect(newest()?.ahead).toBe(1);
  loop.moveStick(NOTHING);
  expect(newest()).toEqual(NOTHING);
});

test("a hand that was lost sight of has let go, until it presses anew", () => {
  const sprung = vi.fn();
  loop.onLetGo(sprung);
  loop.key("KeyW", true);
  loop.moveStick(stickPush(0, -1));
  loop.letGo();
  expect(newest()).toEqual(NOTHING);
  expect(sprung).toHaveBeenCalledOnce();
  vi.advanceTimersByTime(5 * RENEW_MS);
  expect(newest()).toEqual(NOTHING);
  loop.key("KeyW", true);
  expect(newest()?.ahead).toBe(1);
});

test("a gamepad that somebody leans on drives nothing before it was at rest", () => {
  pad = stickPush(0, -1);
  vi.advanceTimersByTime(3 * RENEW_MS);
  loop.letGo();
  vi.advanceTimersByTime(3 * RENEW_MS);
  expect(newest()).toEqual(NOTHING);
  pad = NOTHING;
  vi.advanceTimersByTime(RENEW_MS);
  pad = stickPush(0, -1);
  vi.advanceTimersByTime(RENEW_MS);
  expect(newest()?.ahead).toBe(1);
});

test("a gamepad is not heard while another window has the focus, nor after it before it rests", () => {
  vi.advanceTimersByTime(RENEW_MS);
  pad = stickPush(0, -1);
  vi.advanceTimersByTime(RENEW_MS);
  expect(newest()?.ahead).toBe(1);
  focused = false;
  vi.advanceTimersByTime(RENEW_MS);
  expect(newest()).toEqual(NOTHING);
  focused = true;
  vi.advanceTimersByTime(3 * RENEW_MS);
  expect(newest()).toEqual(NOTHING);
});

test("nothing is told once it has stopped", () => {
  loop.stop();
  told.length = 0;
  loop.key("KeyW", true);
  vi.advanceTimersByTime(5 * RENEW_MS);
  expect(told).toEqual([]);
});
