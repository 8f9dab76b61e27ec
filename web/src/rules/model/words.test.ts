import { expect, test } from "vitest";
import type { Rule, RuleStatus } from "../../api/ruleTypes";
import {
  constantText,
  dayText,
  leftText,
  secondsText,
  statusLevel,
  statusText,
  usedUpText,
  whenText,
} from "./words";

const waitingFor = (kind: string): Rule =>
  ({
    id: "a",
    name: "",
    enabled: true,
    event: { hold: 2, condition: { kind } },
  }) as unknown as Rule;
const rule = waitingFor("compare");
const status = (part: Partial<RuleStatus>): RuleStatus => ({
  rule_id: "a",
  state: "ready",
  text: "",
  left: null,
  verdict: null,
  leaves: [],
  evaluated: 0,
  true: 0,
  fired: 0,
  dropped: 0,
  failed: 0,
  outranked: 0,
  last_fired: null,
  last_ok: null,
  error: "",
  ...part,
});

test("times are relative within a minute and clock time after", () => {
  expect(whenText(1000, 1000.4)).toBe("just now");
  expect(whenText(1000, 1012.9)).toBe("12 s ago");
  expect(whenText(1000, 1075)).toMatch(/^\d\d:\d\d:\d\d$/);
});

test("what is of another day carries its date, and a line where the day begins", () => {
  const at = (...when: [number, number, number]) => new Date(2026, 10, ...when).getTime() / 1000;
  expect(whenText(at(22, 23, 50), at(23, 0, 30))).toMatch(/22/);
  expect(dayText(at(22, 23, 50), at(23, 0, 30))).toMatch(/22/);
  expect(dayText(at(23, 0, 10), at(23, 0, 30))).toBeNull();
});

test("settings keep their precision, countdowns do not jump about", () => {
  expect(secondsText(0.25)).toBe("0.25 s");
  expect(secondsText(200)).toBe("3 min 20 s");
  expect(leftText(41.4)).toBe("41 s");
  expect(leftText(1.23)).toBe("1.2 s");
});

test("a state says how long it lasts", () => {
  expect(statusText(status({ state: "holding", left: 0.8 }), rule)).toBe("holding 1.2/2 s");
  expect(statusText(status({ state: "cooling", left: 41 }), rule)).toBe("cooling 41 s");
  expect(statusText(status({ state: "unknown", text: "scan silent for 3 s" }), rule)).toBe(
    "unknown: scan silent for 3 s",
  );
});

test("a rule that is used up says since when, warns, and tells what it takes", () => {
  const spent = status({ state: "used up", fired: 1, last_ok: true, last_fired: 1000 });
  expect(usedUpText(spent, 1060)).toMatch(
    /^Used up at \d\d:\d\d; will not fire again until reset\.$/,
  );
  expect(usedUpText(spent, 200_000)).toMatch(/^Used up at .*\d\d:\d\d; will not/);
  expect(usedUpText(spent, 200_000)).not.toMatch(/at \d\d:\d\d;/);
  // An engine that was started again knows that, and not when.
  expect(usedUpText({ ...spent, last_fired: null }, 1060)).toBe(
    "Used up; will not fire again until reset.",
  );
  expect(statusLevel(spent, rule)).toBe("degraded");
});

test("a rule that waits for a message is well while none comes", () => {
  const silent = status({ state: "unknown", text: "nothing received yet" });
  expect(statusText(silent, waitingFor("received"))).toBe("waits for a message");
  expect(statusLevel(silent, waitingFor("received"))).toBe("healthy");
});

test("constants are words, without the name of their field", () => {
  expect(constantText("STATUS_FAILURE_ALGORITHM_LEVEL", "status")).toBe("failure algorithm level");
  expect(constantText("UNKNOWN", "reason")).toBe("unknown");
});

test("only what needs a person is loud", () => {
  expect(statusLevel(status({ state: "cooling" }), rule)).toBe("healthy");
  expect(statusLevel(status({ state: "broken" }), rule)).toBe("failed");
  expect(statusLevel(status({ state: "ready", last_ok: false }), rule)).toBe("degraded");
  expect(statusLevel(status({ state: "disabled" }), rule)).toBe("unknown");
});
