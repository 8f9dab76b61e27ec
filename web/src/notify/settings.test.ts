import { describe, expect, it } from "vitest";
import { isQuiet, NOTHING, readSettings } from "./settings";

describe("what this browser keeps", () => {
  it("is read, and nonsense counts as nothing", () => {
    const kept = { sound: true, message: false, quiet: { from: "20:00", to: "06:00" } };
    expect(readSettings(JSON.stringify(kept))).toEqual(kept);
    for (const text of ["", "{", "null", "7", '"x"']) expect(readSettings(text)).toEqual(NOTHING);
    expect(readSettings('{"sound":"yes","quiet":{"from":"25:00","to":"06:00"}}')).toEqual(NOTHING);
  });
});

describe("quiet hours", () => {
  const at = (hour: number, minute = 0) => new Date(2026, 0, 5, hour, minute);
  it("go over midnight, and end on the minute", () => {
    const night = { ...NOTHING, quiet: { from: "20:00", to: "06:00" } };
    expect([19, 20, 23, 0, 5, 6].map((hour) => isQuiet(night, at(hour)))).toEqual([
      ...[false, true, true, true, true, false],
    ]);
    const noon = { ...NOTHING, quiet: { from: "12:00", to: "13:30" } };
    expect([at(11, 59), at(12), at(13, 29), at(13, 30)].map((t) => isQuiet(noon, t))).toEqual([
      ...[false, true, true, false],
    ]);
    expect(isQuiet(NOTHING, at(3))).toBe(false);
  });
});
