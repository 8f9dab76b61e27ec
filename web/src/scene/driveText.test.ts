import { expect, test } from "vitest";
import type { Drive } from "../api/types";
import { silentDriveText } from "./driveText";

const drive: Drive = {
  available: false,
  stopped: true,
  standstill: true,
  stopped_by: "ava",
  reason: "",
  limited_by: "stop",
  driven_by: "",
  speed_factor: 0,
  age: 3,
};

test("a drive manager that answers needs no words", () => {
  expect(silentDriveText({ ...drive, available: true }, 0)).toBeNull();
});

test("a stop that was reported last is not forgotten while nobody answers", () => {
  const text = silentDriveText(drive, 4);
  expect(text).toContain("last heard 7 s ago");
  expect(text).toContain("stopped by ava, and stays so");
});

test("whoever was never heard is another matter than who is silent", () => {
  expect(silentDriveText(null, 0)).toContain("Start the stack");
  expect(silentDriveText({ ...drive, stopped: false }, 0)).not.toContain("stopped");
});
