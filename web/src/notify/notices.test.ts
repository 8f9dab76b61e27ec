import { describe, expect, it } from "vitest";
import type { Goal, MissionRun, Session, State } from "../api/types";
import { DRIVE, robot, stream } from "../state/fixtures";
import { noticesBetween } from "./notices";

const AVA: Session = { user: "ava", key: "a1", role: "operator", account: false };
const titles = (before: Partial<State>, now: Partial<State>) =>
  noticesBetween(robot(before), robot(now), AVA).map(({ title }) => title);

const GOAL: Goal = {
  id: "g1",
  x: 0,
  y: 0,
  yaw: null,
  phase: "driving",
  message: "",
  sent_by: "ava",
  elapsed: 1,
  distance_left: 1,
  eta: 2,
  error: null,
  ended: null,
  hindrance: "",
};

const RUN: MissionRun = {
  number: 1,
  mission: 1,
  name: "Round",
  by: "ava",
  phase: "driving",
  step: 1,
  elapsed: 0,
  round: 1,
  rounds: 1,
  waypoint: 1,
  waypoints: 2,
  attempt: 1,
  place: "Gate",
  task: "",
  ask: "",
  left: null,
  reason: "",
  decided_by: "",
  skipped: [],
};
const mission = (part: Partial<MissionRun>): Partial<State> => ({
  missions: { ...robot().missions, run: { ...RUN, ...part } },
});
const rules = (part: Partial<State["rules"]>): Partial<State> => ({
  rules: { ...robot().rules, available: true, revision: 4, confirmed: 3, ...part },
});

describe("who does not look at the page is told", () => {
  it("that somebody else stopped the robot, once", () => {
    const stopped = { drive: { ...DRIVE, stopped: true, stopped_by: "ben", reason: "a child" } };
    expect(titles({ drive: DRIVE }, stopped)).toEqual(["Stopped by ben: a child"]);
    expect(titles(stopped, stopped)).toEqual([]);
    const mine = { drive: { ...DRIVE, stopped: true, stopped_by: "ava" } };
    expect(titles({ drive: DRIVE }, mine)).toEqual([]);
    expect(titles({ drive: null }, stopped)).toEqual([]); // it was so before
  });

  it("what failed and what to do, and not of what passes by itself", () => {
    const lost = { streams: [stream("scan", "Laser scan", "/scan", { age: 9, stale: true })] };
    const [notice] = noticesBetween(robot(), robot(lost), AVA);
    expect(notice?.title).toBe("Laser scan lost");
    expect(notice?.body).toContain("Check the scanner's power");
    const late = { streams: [stream("scan", "Laser scan", "/scan", { age: 1.5, stale: true })] };
    expect(titles({}, late)).toEqual([]);
  });

  it("that a goal was given up, and of a mission's goal by the mission alone", () => {
    const failed = { ...GOAL, phase: "failed" as const, message: "The way is blocked." };
    expect(titles({ goal: GOAL }, { goal: failed })).toEqual(["The way is blocked."]);
    expect(titles({ goal: failed }, { goal: failed })).toEqual([]);
    const paused = { ...mission({ phase: "paused", step: 2, reason: "blocked" }), goal: failed };
    expect(titles({ ...mission({}), goal: GOAL }, paused)).toEqual(["Round: paused, next is Gate"]);
  });

  it("that a mission waits for a person, has paused, failed or is done", () => {
    const [asks] = noticesBetween(
      robot(mission({})),
      robot(mission({ phase: "asking", step: 2, ask: "Load it" })),
      AVA,
    );
    expect(asks).toMatchObject({ title: "Round: waits for a person at Gate", body: "Load it" });
    const again = mission({ phase: "asking", step: 3, ask: "And this" });
    expect(titles(mission({ phase: "asking", step: 2 }), again)).toHaveLength(1);
    expect(titles(mission({}), mission({ phase: "done", step: 2 }))).toEqual([
      "Round: mission done",
    ]);
    const mine = mission({ phase: "paused", step: 2, decided_by: "ava" });
    expect(titles(mission({}), mine)).toEqual([]);
  });

  it("of alarms, and how a probation ended", () => {
    expect(titles(rules({}), rules({ alarms: 1 }))).toEqual(["A rule has raised an alarm"]);
    expect(titles(rules({ alarms: 1 }), rules({}))).toEqual([]);
    const probation = rules({ probation_left: 3 });
    expect(titles(probation, rules({ confirmed: 4 }))).toEqual([
      "Probation of revision 4 has ended",
    ]);
    expect(titles(probation, rules({ revision: 5 }))).toEqual([
      "Rules went back: revision 5 is in force",
    ]);
  });

  it("that control is asked for or was taken", () => {
    const mine = { ...robot().control, holder: "ava", holder_key: "a1" };
    const asked = { ...mine, asked_by: "ben", asked_key: "b1" };
    expect(titles({ control: mine }, { control: asked })).toEqual(["ben asks you for control"]);
    const taken = { ...mine, holder: "ben", holder_key: "b1", taken_from: "ava", taken_key: "a1" };
    expect(titles({ control: mine }, { control: taken })).toEqual([
      "ben has taken control from you",
    ]);
  });

  it("tells once that the battery is low, and not while it is charged", () => {
    const charge = (part: Partial<NonNullable<State["battery"]>>) => ({
      battery: {
        charge: 0.5,
        charging: false,
        low: false,
        voltage: null,
        topic: "/b",
        age: 0,
        ...part,
      },
    });
    const low = charge({ charge: 0.19, low: true });
    expect(titles(charge({}), low)).toEqual(["Battery low: 19 %"]);
    expect(titles(low, charge({ charge: 0.18, low: true }))).toEqual([]);
    expect(titles({ battery: null }, low)).toEqual([]);
    expect(titles(charge({}), charge({ charge: 0.19, low: true, charging: true }))).toEqual([]);
  });
});
