import { expect, test } from "vitest";
import type { Drive } from "../api/types";
import { drivenText, heldBackText } from "./handText";

const free: Drive = {
  available: true,
  stopped: false,
  standstill: false,
  stopped_by: "",
  reason: "",
  limited_by: "",
  driven_by: "ava",
  speed_factor: 1,
  age: 0,
};

test("a robot that nothing holds back needs no words", () => {
  expect(heldBackText(free)).toBeNull();
});

test("what holds the robot back is told to the hand, and what to do", () => {
  expect(heldBackText({ ...free, stopped: true, limited_by: "stop" })).toContain("release");
  expect(heldBackText({ ...free, limited_by: "let go first" })).toContain("Let go first");
  expect(heldBackText({ ...free, limited_by: "obstacle", speed_factor: 0 })).toContain("obstacle");
  expect(heldBackText({ ...free, limited_by: "obstacle", speed_factor: 0.4 })).toContain("40 %");
  expect(heldBackText({ ...free, limited_by: "scan stale", speed_factor: 0 })).toContain("scan");
  expect(heldBackText({ ...free, limited_by: "command stale" })).toContain("not heard");
  expect(heldBackText({ ...free, limited_by: "steered wheels" })).toContain("push ahead or back");
  expect(heldBackText(null)).toContain("silent");
});

test("the driver is told as you to the driver alone", () => {
  expect(drivenText("ava", true)).toBe("You drive");
  expect(drivenText("ava", false)).toBe("Driven by ava");
});
