import { expect, test } from "vitest";
import type { Drill, DrillDrive } from "../../api/drillTypes";
import { faultsText, progressText, roughText, subjectText, tallyText, wishText } from "./drillText";

const drill = (done: number, total: number, left: number | null): Drill => ({
  id: "a",
  state: "running",
  by: "ava",
  revision: 3,
  done,
  total,
  elapsed: 0,
  left,
  error: null,
  wish: { faults: ["all"], world: "hexagon", drives: 20, scenario: null },
  report: null,
});
const drive = (change: DrillDrive["change"]): DrillDrive => ({
  name: "1-0",
  world: "hexagon",
  faults: [],
  change,
  why: "",
  text: "",
  proposed: "arrived",
  in_force: "arrived",
});

test("nothing is said of the time that is left before a drive has told how long one takes", () => {
  expect(progressText(drill(0, 40, null))).not.toContain("left");
  expect(progressText(drill(12, 40, 118))).toBe("12 of 40 drives, about 2 min left");
  expect(progressText(drill(40, 40, 0))).toBe("40 of 40 drives");
});

test("what was asked for is told as people say it", () => {
  const { wish } = drill(0, 40, null);
  expect(wishText(wish)).toBe("any fault; 20 drives under each table, in hexagon");
  expect(wishText({ ...wish, faults: ["way_blocked", "kill:mapper"], drives: 1 })).toBe(
    "way blocked, kill mapper; 1 drive under each table, in hexagon",
  );
  expect(wishText({ ...wish, scenario: "monday" })).toContain("monday; 20 drives");
});

test("an estimate is told in round numbers, and never as none", () => {
  expect(roughText(0.2)).toBe("10 s");
  expect(roughText(44)).toBe("40 s");
  expect(roughText(100)).toBe("1 min 30 s");
  expect(roughText(1000)).toBe("17 min");
});

test("a drive is told by what broke in it, as one says it", () => {
  const broken = [
    { name: "way_blocked", at: 12.34, duration: 8 },
    { name: "kill:controller", at: 3, duration: 0 },
  ];
  expect(faultsText(broken)).toBe("way blocked at 12.3 s for 8.0 s, kill controller at 3.0 s");
  expect(faultsText([])).toBe("no fault");
});

test("only what there is is counted", () => {
  expect(tallyText([drive("same"), drive("worse"), drive("same")])).toBe("1 worse, 2 the same");
});

test("whose robot drives is said, and whether that is the one at hand", () => {
  expect(subjectText("patrol.py", "omni", "hexagon", null)).toContain("It is not your robot");
  expect(subjectText("patrol.py", "omni", "hexagon", "hexagon")).not.toContain("not your robot");
});
