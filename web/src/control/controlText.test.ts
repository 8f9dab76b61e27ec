import { describe, expect, it } from "vitest";
import type { Control, Session } from "../api/types";
import { robot } from "../state/fixtures";
import { controlView } from "./controlText";

const AVA: Session = { user: "ava", key: "a1", role: "operator", account: false };
const control = (part: Partial<Control> = {}): Control => ({ ...robot().control, ...part });

describe("control of the robot", () => {
  it("is mine, another's or nobody's", () => {
    expect(controlView(control(), AVA, 0).whose).toBe("nobody");
    const mine = control({ holder: "ava", holder_key: "a1" });
    expect(controlView(mine, AVA, 0)).toMatchObject({ whose: "mine", text: "You have control" });
    const ben = control({ holder: "ben", holder_key: "b1" });
    expect(controlView(ben, AVA, 0)).toMatchObject({ whose: "other", text: "ben has control" });
  });

  it("tells who has it of an ask, and who asks how long an answer may take", () => {
    const asked = { asked_by: "ben", asked_key: "b1", asked: 5 };
    const mine = control({ holder: "ava", holder_key: "a1", ...asked });
    expect(controlView(mine, AVA, 0)).toMatchObject({ askedBy: "ben", waits: null });
    const ben: Session = { ...AVA, user: "ben", key: "b1" };
    expect(controlView(mine, ben, 3)).toMatchObject({ askedBy: "", waits: 12 });
    expect(controlView(mine, ben, 60).waits).toBe(0);
    const other: Session = { ...AVA, user: "cleo", key: "c1" };
    expect(controlView(mine, other, 0)).toMatchObject({ askedBy: "", waits: null });
  });

  it("tells from whom it was taken, by whom and why, and nobody else", () => {
    const taken = control({
      holder: "ben",
      holder_key: "b1",
      taken_from: "ava",
      taken_key: "a1",
      reason: "the dock is free",
    });
    expect(controlView(taken, AVA, 0).lost).toEqual({ by: "ben", reason: "the dock is free" });
    expect(controlView(taken, { ...AVA, key: "a2" }, 0).lost).toBeNull();
  });

  it("of an account on another device is one's own", () => {
    const there = control({ holder: "ava", holder_key: "a2" });
    expect(controlView(there, { ...AVA, account: true }, 0).own).toBe(true);
    expect(controlView(there, AVA, 0).own).toBe(false); // anybody may call himself ava
  });

  it("is asked for, taken by an engineer, or taken from one's own other device", () => {
    const there = control({ holder: "ava", holder_key: "a2" });
    const remedy = (session: Partial<Session>) =>
      controlView(there, { ...AVA, ...session }, 0).remedy;
    expect(remedy({ user: "ben" })).toBe("Ask for it in the bar at the top.");
    expect(remedy({ user: "eve", role: "engineer" })).toContain("or take it there and say why");
    expect(remedy({ account: true })).toBe("Take it in the bar at the top.");
  });

  it("of somebody who goes by the same name is another page's", () => {
    const there = control({ holder: "ava", holder_key: "a2" });
    expect(controlView(there, AVA, 0).text).toBe("Another page (ava) has control");
    const asked = control({ holder: "ava", holder_key: "a1", asked_by: "ava", asked_key: "a2" });
    expect(controlView(asked, AVA, 0).askedBy).toBe("Another page (ava)");
  });
});
