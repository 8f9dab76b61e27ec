/** Conditions ready-made for this robot, worded as an operator would say them. */
import type { Condition, ConditionKind, Graph, GraphTopic, Signal } from "../../api/ruleTypes";
import { bare, slashed, title } from "./actions";
import { fieldChoices, sensibleTimeout, topicOf } from "./signals";

export interface Preset {
  key: string;
  group: string;
  label: string;
  make: () => Condition;
}

const LASER = "sensor_msgs/msg/LaserScan";
const STATUS = /\/ComponentStatus$/;
/** Topics that never pause while all is well. */
const STREAMS = /(LaserScan|Odometry|Imu|OccupancyGrid|PointCloud2|Image)$/;
/** Topics that carry what a person asks for, one message each time. */
const ASKED = /PointStamped$|PoseStamped$/;

function signal(topic: GraphTopic, path: Signal["path"] = []): Signal {
  return {
    topic: bare(topic.name),
    type: topic.type,
    path,
    aggregate: null,
    timeout: sensibleTimeout(topic),
  };
}

export function presets(graph: Graph | null): Preset[] {
  const found: Preset[] = [];
  const add = (key: string, group: string, label: string, make: () => Condition) =>
    found.push({ key, group, label, make });
  for (const topic of graph?.topics ?? []) {
    const name = bare(topic.name);
    const where = slashed(topic.name);
    if (topic.type === LASER) {
      add(`near:${name}`, "Obstacles", `Nearest obstacle is closer than … (${where})`, () => ({
        kind: "compare",
        signal: { ...signal(topic, ["ranges"]), aggregate: "min" },
        operator: "<",
        value: 0.3,
        tolerance: 0,
      }));
    }
    if (
      STATUS.test(topic.type) &&
      topic.component !== "" &&
      !found.some((p) => p.key === `status:${topic.component}`)
    ) {
      const status = fieldChoices(graph, topic.type).find((field) => field.label === "status");
      const failure = Object.entries(status?.constants ?? {}).find(([constant]) =>
        constant.includes("ALGORITHM"),
      );
      // Whatever the reason: it fails, or its process is dead, hung or gone.
      add(`unwell:${topic.component}`, "Health", `${title(topic.component)} is not well`, () => ({
        kind: "compare",
        signal: signal(topic, ["status"]),
        operator: "!=",
        value: status?.constants.STATUS_HEALTHY ?? 0,
        tolerance: 0,
      }));
      add(
        `status:${topic.component}`,
        "Health",
        `${title(topic.component)} reports a failure`,
        () => ({
          kind: "compare",
          signal: signal(topic, ["status"]),
          operator: "==",
          value: failure?.[1] ?? 1,
          tolerance: 0,
        }),
      );
    }
  }
  for (const topic of graph?.topics ?? []) {
    const name = bare(topic.name);
    if (ASKED.test(topic.type)) {
      add(`received:${name}`, "Messages", `A message arrives on ${slashed(name)}`, () => ({
        kind: "received",
        signal: signal(topic),
      }));
    }
    if (!topic.latched && topic.publishers > 0 && STREAMS.test(topic.type)) {
      add(`absent:${name}`, "Silence", `${slashed(name)} is silent for …`, () => ({
        kind: "absent",
        signal: signal(topic),
        seconds:
          topic.rate !== null && topic.rate > 0 ? Math.max(1, Math.round(10 / topic.rate)) : 2,
        from_start: true,
      }));
    }
  }
  return found;
}

export const KIND_WORDS: Record<
  Exclude<ConditionKind, "all" | "any" | "not" | "callable">,
  string
> = {
  compare: "a value compares",
  changed: "a value changes",
  received: "a message arrives",
  absent: "silence lasts",
  rate: "messages come too fast or slow",
};

/** A condition of a kind about a topic, keeping the topic where there is one. */
export function blank(
  kind: keyof typeof KIND_WORDS,
  graph: Graph | null,
  from: Signal | null,
): Condition {
  const base: Signal = from ?? { topic: "", type: "", path: [], aggregate: null, timeout: 1 };
  const topic = topicOf(graph, base.topic);
  switch (kind) {
    case "compare":
      return { kind, signal: base, operator: "==", value: 0, tolerance: 0 };
    case "changed":
      return { kind, signal: base, deadband: 0 };
    case "received":
      return { kind, signal: { ...base, path: [], aggregate: null } };
    case "absent":
      return {
        kind,
        signal: { ...base, path: [], aggregate: null },
        seconds: 2,
        from_start: true,
      };
    case "rate":
      return {
        kind,
        topic: base.topic,
        type: base.type === "" ? null : base.type,
        below: topic?.rate != null ? Math.max(0.1, Math.round(topic.rate * 5) / 10) : 1,
        above: null,
        window: 2,
      };
  }
}
