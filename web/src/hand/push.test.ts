import { expect, test } from "vitest";
import { isNothing, keysPush, NOTHING, padPush, stickPush, sum, twistOf } from "./push";

const pad = (...axes: number[]) => ({ axes, connected: true });

test("keys are known by their place, so that every layout drives alike", () => {
  expect(keysPush(["KeyW", "KeyA"])).toEqual({ ahead: 1, round: 1, aside: 0 });
  expect(keysPush(["ArrowDown", "ArrowRight"])).toEqual({ ahead: -1, round: -1, aside: 0 });
  expect(keysPush(["KeyG"])).toEqual(NOTHING);
});

test("keys against each other cancel, and two for one direction are no more than one", () => {
  expect(keysPush(["KeyW", "KeyS"])).toEqual(NOTHING);
  expect(keysPush(["KeyW", "ArrowUp"]).ahead).toBe(1);
});

test("the stick is full at its edge, and beyond it no more", () => {
  expect(stickPush(0, -1)).toEqual({ ahead: 1, round: 0, aside: 0 });
  expect(stickPush(0, -3)).toEqual({ ahead: 1, round: 0, aside: 0 });
  expect(stickPush(1, 0).round).toBe(-1);
  const { ahead, round } = stickPush(-3, -3);
  expect(Math.hypot(ahead, round)).toBeCloseTo(1);
});

test("a hand that rests on a stick drives nothing, and just beyond it the robot creeps", () => {
  expect(isNothing(stickPush(0.1, -0.1))).toBe(true);
  expect(stickPush(0, -0.16).ahead).toBeGreaterThan(0);
  expect(stickPush(0, -0.16).ahead).toBeLessThan(0.05);
  expect(isNothing(padPush([null, pad(0.1, 0.05, -0.1), { axes: [1, 1], connected: false }]))).toBe(
    true,
  );
});

test("a stick that tells no number drives nothing", () => {
  expect(isNothing(stickPush(Number.NaN, -1))).toBe(true);
});

test("a gamepad drives with its left stick and slides with its right one", () => {
  expect(padPush([pad(0, -1, 0, 0)])).toEqual({ ahead: 1, round: 0, aside: 0 });
  expect(padPush([pad(0, 0, -1, 0)])).toEqual({ ahead: 0, round: 0, aside: 1 });
});

test("all hands together are no faster than one", () => {
  expect(sum([stickPush(0, -1), keysPush(["KeyW"])]).ahead).toBe(1);
});

test("the twist is a share of what the robot can do, and never aside where it cannot", () => {
  const limits = { vx: 0.4, vy: 0, omega: 2 };
  expect(twistOf({ ahead: 1, round: -0.5, aside: 1 }, limits, 0.5)).toEqual({
    vx: 0.2,
    vy: 0,
    omega: -0.5,
  });
});
