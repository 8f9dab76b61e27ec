import { expect, test } from "vitest";
import type { Drive } from "../api/types";
import {
  CONFIRM_WITHIN_MS,
  IDLE,
  type StopEvent,
  type StopState,
  stopReducer,
} from "./stopMachine";

const free: Drive = {
  available: true,
  stopped: false,
  standstill: false,
  stopped_by: "",
  reason: "",
  limited_by: "",
  driven_by: "",
  speed_factor: 1,
  age: 0,
};
const latched: Drive = { ...free, stopped: true, stopped_by: "ava" };
const still: Drive = { ...latched, standstill: true };

const see = (drive: Drive | null, now: number): StopEvent => ({ type: "observed", drive, now });
const after = (...events: StopEvent[]): StopState => events.reduce(stopReducer, IDLE);
const pressed: StopEvent = { type: "pressed", now: 0 };

test("a press shows at once that the robot is being stopped", () => {
  expect(after(pressed).phase).toBe("stopping");
});

test("stopped is shown only with the latch and a measured standstill", () => {
  expect(after(pressed, see(latched, 300)).phase).toBe("stopping");
  expect(after(pressed, see({ ...free, standstill: true }, 300)).phase).toBe("stopping");
  expect(after(pressed, see(latched, 300), see(still, 900)).phase).toBe("stopped");
});

test("a stopped robot that falls silent was stopped, and is so again when it speaks", () => {
  const silent = after(pressed, see(still, 300), see(null, 2000));
  expect(silent.phase).toBe("silent");
  expect(stopReducer(silent, see(null, 60_000)).phase).toBe("silent");
  expect(stopReducer(silent, see(still, 60_000)).phase).toBe("stopped");
  const back = stopReducer(silent, see(latched, 60_000));
  expect(back.phase).toBe("stopping");
  expect(stopReducer(back, see(still, 60_100)).phase).toBe("stopped");
  expect(stopReducer(silent, see(free, 60_000)).phase).toBe("idle");
  expect(stopReducer(silent, pressed).phase).toBe("stopping");
});

test("without a standstill in time the stop is not confirmed", () => {
  const state = after(pressed, see(latched, 300), see(latched, CONFIRM_WITHIN_MS));
  expect(state.phase).toBe("unconfirmed");
  expect(state.problem).toContain("standstill");
  expect(state.remedy).toContain("emergency button");
});

test("a silent drive manager confirms nothing", () => {
  const state = after(pressed, see(null, CONFIRM_WITHIN_MS));
  expect(state.phase).toBe("unconfirmed");
  expect(state.problem).toContain("silent");
});

test("a refused request is told at once, and a standstill seen later settles it", () => {
  const refused: StopEvent = { type: "refused", problem: "No answer.", remedy: "Look." };
  expect(after(pressed, refused)).toMatchObject({ phase: "unconfirmed", problem: "No answer." });
  expect(after(pressed, refused, see(still, 900)).phase).toBe("stopped");
});

test("a late refusal does not undo a stop that was measured", () => {
  const refused: StopEvent = { type: "refused", problem: "No answer.", remedy: "" };
  expect(after(pressed, see(still, 400), refused).phase).toBe("stopped");
});

test("a stop by somebody else is followed the same way", () => {
  expect(after(see(latched, 100)).phase).toBe("stopping");
  expect(after(see(latched, 100), see(latched, 100 + CONFIRM_WITHIN_MS)).phase).toBe("unconfirmed");
  expect(after(see(still, 100)).phase).toBe("stopped");
});

test("a stopped robot that moves again is not called stopped", () => {
  expect(after(see(still, 100), see(latched, 200)).phase).toBe("unconfirmed");
});

test("a release brings the button back, from every phase", () => {
  expect(after(see(still, 100), see(free, 200)).phase).toBe("idle");
  expect(after(pressed, see(latched, 100), see(free, 200)).phase).toBe("idle");
  expect(after(pressed, see(latched, 100), see(latched, 9000), see(free, 9100)).phase).toBe("idle");
});

test("a report from before the press does not end it", () => {
  expect(after(pressed, see(free, 50)).phase).toBe("stopping");
});

test("when the robot falls silent, its last standstill is no longer shown as the present", () => {
  expect(after(see(still, 100), see(null, 5000)).phase).not.toBe("stopped");
});

test("an alarm can be put away only while nothing is latched", () => {
  const dismiss: StopEvent = { type: "dismissed" };
  expect(after(pressed, see(null, 9000), dismiss).phase).toBe("idle");
  expect(after(pressed, see(latched, 9000), dismiss).phase).toBe("unconfirmed");
});
