import { describe, expect, it } from "vitest";
import type { Prospect } from "../../api/ruleTypes";
import { actsAtOnce, mayAct } from "./prospects";

const prospect = (fires: Prospect["fires"], acts: boolean): Prospect => ({
  rule_id: "r",
  fires,
  seconds: null,
  acts,
  text: "",
});

describe("what is to be expected of a rule", () => {
  it("warns of what stops or moves the robot by itself, and of nothing else", () => {
    for (const fires of ["soon", "with a message", "if silent"] as const) {
      expect(actsAtOnce(prospect(fires, true))).toBe(true);
      expect(actsAtOnce(prospect(fires, false))).toBe(false);
    }
    for (const fires of ["when next true", "with a change", "unknown"] as const) {
      expect(actsAtOnce(prospect(fires, true))).toBe(false);
    }
  });

  it("does not keep silent of what nobody knows", () => {
    expect(mayAct(prospect("unknown", true))).toBe(true);
    expect(mayAct(prospect("unknown", false))).toBe(false);
    expect(mayAct(prospect("when next true", true))).toBe(false);
  });
});
