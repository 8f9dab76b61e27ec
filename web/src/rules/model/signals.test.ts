import { expect, test } from "vitest";
import type { Compare, Graph, GraphField, GraphTopic } from "../../api/ruleTypes";
import { atText, clusters, pan, ticks, zoom } from "../review/timeline";
import { actionChoices, actionText, choiceKey } from "./actions";
import {
  fittingReferences,
  flatten,
  isReference,
  kindOf,
  messageFields,
  references,
} from "./arguments";
import { presets } from "./presets";
import { fieldChoices, fitLiteral, operatorsFor, sensibleTimeout, withField } from "./signals";

const LASER = "sensor_msgs/msg/LaserScan";
const STATUS = "kompass_interfaces/msg/ComponentStatus";
const field = (
  text: string,
  kind: GraphField["kind"],
  part: Partial<GraphField> = {},
): GraphField => ({
  path: text.split("."),
  text,
  kind,
  element: "",
  constants: {},
  ...part,
});
const topic = (name: string, type: string, part: Partial<GraphTopic> = {}): GraphTopic => ({
  name,
  type,
  latched: false,
  publishers: 1,
  component: "",
  rate: 10,
  silent: null,
  ...part,
});
const graph: Graph = {
  refused: {},
  topics: [
    topic("/scan", LASER),
    topic("/controller/status", STATUS, { component: "controller", latched: true, rate: null }),
    topic("/clicked_point", "geometry_msgs/msg/PointStamped", { rate: null }),
  ],
  types: {
    [LASER]: [
      field("header.frame_id", "text"),
      field("ranges", "list", { element: "float" }),
      field("range_min", "float"),
    ],
    [STATUS]: [
      field("status", "int", { constants: { STATUS_HEALTHY: 0, STATUS_FAILURE_ALGORITHM: 1 } }),
    ],
    "geometry_msgs/msg/PointStamped": [field("point", "message"), field("point.x", "float")],
    "kompass_interfaces/action/PlanPath_Goal": [field("goal.position.x", "float")],
  },
  components: [
    {
      name: "drive_manager",
      kind: "DriveManager",
      methods: [{ name: "move_to_unblock", text: "Move where there is room.", arguments: [] }],
      parameters: [{ name: "rate", kind: "float", value: 10, text: "" }],
    },
  ],
  services: [],
  actions: [{ name: "/planner/plan_path", type: "kompass_interfaces/action/PlanPath" }],
  functions: [],
};
const compare: Compare = {
  kind: "compare",
  signal: { topic: "scan", type: LASER, path: [], aggregate: null, timeout: 1 },
  operator: "==",
  value: 0,
  tolerance: 0.1,
};

test("the nearest obstacle is offered in words, headers come last", () => {
  const labels = fieldChoices(graph, LASER).map(({ label }) => label);
  expect(labels[0]).toBe("nearest obstacle – min(ranges)");
  expect(labels.at(-1)).toBe("header.frame_id");
});

test("choosing another field keeps what fits and mends what does not", () => {
  const nearest = fieldChoices(graph, LASER)[0];
  if (nearest === undefined) throw new Error("no fields");
  expect(withField({ ...compare, operator: "<", value: 0.3 }, nearest)).toMatchObject({
    operator: "<",
    value: 0.3,
    tolerance: 0,
    signal: { path: ["ranges"], aggregate: "min" },
  });
  expect(withField({ ...compare, operator: "contains", value: "x" }, nearest)).toMatchObject({
    operator: "<",
    value: 0,
  });
});

test("operators fit the kind of the value, and literals the operator", () => {
  expect(operatorsFor({ kind: "bool", constants: {} }).map(({ value }) => value)).toEqual([
    "==",
    "!=",
  ]);
  expect(fitLiteral("between", "float", 0.5)).toEqual([0.5, 0.5]);
  expect(fitLiteral("in", "int", 3)).toEqual([3]);
  expect(fitLiteral("==", "bool", 3)).toBe(true);
  expect(fitLiteral("<", "float", "0.25")).toBe(0.25);
});

test("a value goes out of date as its topic is fast, and never where it is latched", () => {
  expect(sensibleTimeout(topic("/map", "x", { latched: true }))).toBeNull();
  expect(sensibleTimeout(topic("/scan", "x", { rate: 10 }))).toBe(1);
  expect(sensibleTimeout(topic("/slow", "x", { rate: 1 }))).toBe(3);
});

test("ready-made conditions name topics, types and constants by themselves", () => {
  const made = Object.fromEntries(presets(graph).map((preset) => [preset.key, preset.make()]));
  expect(made["near:scan"]).toMatchObject({
    signal: { type: LASER, aggregate: "min" },
    value: 0.3,
  });
  expect(made["status:controller"]).toMatchObject({ signal: { timeout: null }, value: 1 });
  expect(made["received:clicked_point"]).toMatchObject({ kind: "received" });
});

test("everything that can be done has a choice of its own, and is known by it again", () => {
  const choices = actionChoices(graph, "engineer");
  expect(new Set(choices.map(({ key }) => key)).size).toBe(choices.length);
  for (const choice of choices) expect(choiceKey(choice.make())).toBe(choice.key);
  const move = choices.find(({ key }) => key === "method:drive_manager:move_to_unblock");
  expect(move && actionText(move.make())).toBe("drive_manager: move to unblock");
});

test("arguments are one level of fields, and may come from the message", () => {
  expect(flatten({ goal: { position: { x: 1 } }, list: [1], empty: {} })).toEqual({
    "goal.position.x": 1,
    list: [1],
    empty: {},
  });
  expect(messageFields(graph, "kompass_interfaces/action/PlanPath_Goal")).toMatchObject([
    { name: "goal.position.x", kind: "float", initial: 0 },
  ]);
  const clicked = references(graph, {
    kind: "received",
    signal: { ...compare.signal, topic: "clicked_point", type: "geometry_msgs/msg/PointStamped" },
  });
  expect(fittingReferences(clicked, "float").map(({ value }) => value)).toEqual(["$msg.point.x"]);
  expect([isReference("$msg.x"), isReference("$$5")]).toEqual([true, false]);
  expect([kindOf("float64", null), kindOf("", true), kindOf("str", 1)]).toEqual([
    "float",
    "bool",
    "text",
  ]);
});

test("marks that would hide each other are told as one, each verdict for itself", () => {
  const mark = (at: number, verdict: "same" | "new") => ({
    rule_id: "a",
    time: at,
    at,
    verdict,
    leaves: [],
    text: "",
    assumed: false,
  });
  const found = clusters(
    [mark(1, "same"), mark(1.2, "same"), mark(1.3, "new"), mark(9, "same")],
    { from: 0, to: 10 },
    0.5,
  );
  expect(found.map(({ at, firings }) => [at, firings.length])).toEqual([
    [1, 2],
    [1.3, 1],
    [9, 1],
  ]);
});

test("looking closer keeps the moment under the hand and never leaves the recording", () => {
  const whole = { from: 0, to: 600 };
  expect(zoom(whole, whole, 0.5, 300)).toEqual({ from: 150, to: 450 });
  expect(zoom({ from: 0, to: 100 }, whole, 100, 50)).toEqual(whole);
  expect(pan({ from: 500, to: 600 }, whole, 0.5)).toEqual({ from: 500, to: 600 });
  expect(ticks({ from: 0, to: 600 }, 6)).toEqual([0, 120, 240, 360, 480, 600]);
  expect(atText(754)).toBe("12:34");
});
