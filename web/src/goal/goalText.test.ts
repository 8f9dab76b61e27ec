import { expect, test } from "vitest";
import type { Drive, Goal } from "../api/types";
import type { Cause } from "../state/causes";
import { goalCheck as check } from "./fixtures";
import { checkText, goalLine, isUnderWay, limitText, placeText } from "./goalText";

const goal: Goal = {
  id: "a",
  phase: "driving",
  x: 1,
  y: 2,
  yaw: null,
  sent_by: "ava",
  message: "",
  distance_left: 2.1,
  eta: 9.2,
  error: null,
  elapsed: 3,
  ended: null,
  hindrance: "",
};
const drive: Drive = {
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

test("a clear goal says how far, how long, and that it is clear", () => {
  expect(checkText(check)).toBe("4.2 m, about 21 s, clear");
  expect(checkText({ ...check, length: null, duration: null })).toBe("Clear");
});

test("a refused goal says why in the planner's words", () => {
  const refused = { ...check, ok: false, message: "That point is in a wall." };
  expect(checkText(refused)).toBe("That point is in a wall.");
});

test("a goal under way says what is left of it", () => {
  expect(goalLine(goal, null).text).toBe("2.1 m left, about 9 s");
  expect(goalLine({ ...goal, eta: null }, null).text).toBe("2.1 m left");
  expect(goalLine({ ...goal, distance_left: null }, null).text).toBe("On the way");
  expect(goalLine({ ...goal, distance_left: 0, yaw: 1.5 }, null).text).toBe(
    "There; turns to its heading",
  );
});

test("an arrival says how far off it is", () => {
  const line = goalLine({ ...goal, phase: "arrived", error: 0.041 }, null);
  expect(line).toMatchObject({ tone: "done", text: "Arrived, 4 cm off" });
  expect(goalLine({ ...goal, phase: "arrived", error: 0.002 }, null).text).toBe(
    "Arrived, less than 1 cm off",
  );
});

test("a failed goal says why, and what to do", () => {
  const line = goalLine(
    { ...goal, phase: "failed", message: "No path around the obstacle." },
    null,
  );
  expect(line.tone).toBe("problem");
  expect(line.text).toBe("No path around the obstacle.");
  expect(line.more).not.toBe("");
});

test("a goal that nobody accepts becomes a problem after three seconds", () => {
  expect(goalLine({ ...goal, phase: "sent", elapsed: 1 }, null).tone).toBe("plain");
  expect(goalLine({ ...goal, phase: "sent", elapsed: 4 }, null).tone).toBe("problem");
});

test("only goals that have not ended are under way", () => {
  const phases = ["sent", "accepted", "driving", "arrived", "failed", "canceled"] as const;
  expect(phases.filter((phase) => isUnderWay({ ...goal, phase }))).toEqual([
    "sent",
    "accepted",
    "driving",
  ]);
  expect(isUnderWay(null)).toBe(false);
});

test("a held robot says what holds it, a free one nothing", () => {
  expect(limitText(drive)).toBeNull();
  expect(limitText({ ...drive, limited_by: "obstacle", speed_factor: 0.4 })).toBe(
    "Slowed to 40 %: an obstacle is close",
  );
  expect(limitText({ ...drive, limited_by: "scan stale", speed_factor: 0 })).toBe(
    "Held: a scanner or camera is silent",
  );
});

test("a place names its heading only where there is one", () => {
  expect(placeText(1.5, -0.25, null)).toBe("x 1.50, y −0.25 m");
  expect(placeText(0, 0, Math.PI / 2)).toBe("x 0.00, y 0.00 m, heading 90°");
});

test("a goal that failed says who stopped the robot since, and no longer to send it again", () => {
  const failed: Goal = { ...goal, phase: "failed", message: "Stopped: operator pressed STOP." };
  const by = (stopped_by: string): Drive => ({ ...drive, stopped: true, stopped_by });
  expect(goalLine(failed, drive).more).toBe("Pick another point, or send the goal again.");
  expect(goalLine(failed, by("operator")).more).toBe("When STOP is released, send the goal again.");
  expect(goalLine(failed, by("rule Walls")).more).toBe(
    "That was before rule Walls stopped the robot.",
  );
});

test("where the robot itself is not well another point is no advice", () => {
  const failed = { ...goal, phase: "failed" as const, message: "The way is not driven." };
  const cause: Cause = {
    level: "failed",
    name: "Laser scan lost",
    text: "Laser scan lost 34 s ago",
    effects: [],
    advice: "Check the scanner.",
    others: 0,
    minor: false,
  };
  expect(goalLine(failed, drive, cause).more).toBe(
    "Laser scan lost 34 s ago. When that is mended, send the goal again.",
  );
  expect(goalLine(failed, drive, { ...cause, minor: true }).more).toContain("another point");
});
