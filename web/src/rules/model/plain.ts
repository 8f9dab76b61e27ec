/** Conditions and actions as people say them; the robot's own form is a press away (`InWords`). */
import type {
  Action,
  Compare,
  Condition,
  Graph,
  Leaf,
  Operator,
  Signal,
} from "../../api/ruleTypes";
import { listText } from "../../format";
import { actionText, bare, title, valueText } from "./actions";
import { type ConstantName, isGroup } from "./condition";
import { topicOf } from "./signals";
import { secondsText } from "./words";

/** What a robot's things are called by its people. */
export interface Names {
  /** Of a component, by its name: "Controller". */
  component: (name: string) => string;
  /** Of a number that a message type has a name for. */
  constant: ConstantName;
  graph: Graph | null;
}

/** Of what a component says of itself, by its status. */
const STATUS_WORDS: readonly string[] = [
  "is well",
  "finds no solution",
  "has failed",
  "lacks something that it needs",
  "has failed",
];
const STATUS = /\/ComponentStatus$/;
/** Topics that people have a word for, by the type of their messages. */
const TOPIC_WORDS: Readonly<Record<string, string>> = {
  "sensor_msgs/msg/LaserScan": "laser scan",
  "sensor_msgs/msg/BatteryState": "battery",
  "nav_msgs/msg/Odometry": "odometry",
};

const OPERATORS: Readonly<Record<Exclude<Operator, "between">, [is: string, isNot: string]>> = {
  "==": ["is", "is not"],
  "!=": ["is not", "is"],
  "<": ["is less than", "is at least"],
  "<=": ["is at most", "is more than"],
  ">": ["is more than", "is at most"],
  ">=": ["is at least", "is less than"],
  in: ["is one of", "is none of"],
  not_in: ["is none of", "is one of"],
  contains: ["contains", "does not contain"],
  not_contains: ["does not contain", "contains"],
  contains_any: ["contains any of", "contains none of"],
  not_contains_any: ["contains none of", "contains any of"],
  contains_all: ["contains all of", "lacks some of"],
  not_contains_all: ["lacks some of", "contains all of"],
};

/** A condition in one line, without numbers for states and without the robot's names for topics. */
export function plainCondition(condition: Condition, names: Names): string {
  return told(condition, names, true);
}

/** @param holds false for its opposite: nobody says "not" and then a whole sentence. */
function told(condition: Condition, names: Names, holds: boolean): string {
  if (condition.kind === "not") return told(condition.condition, names, !holds);
  if (isGroup(condition)) {
    const word = joinedBy(condition, holds) ?? "and";
    const parts = condition.conditions.map((child) => {
      const text = told(child, names, holds);
      const inner = joinedBy(child, holds);
      return inner !== null && inner !== word ? `(${text})` : text;
    });
    return parts.join(` ${word} `);
  }
  return leafText(condition, names, holds);
}

/** How the parts of a group go together as it is told; null where there are not several. */
function joinedBy(condition: Condition, holds: boolean): "and" | "or" | null {
  if (condition.kind === "not") return joinedBy(condition.condition, !holds);
  if (!isGroup(condition) || condition.conditions.length < 2) return null;
  // Not all of them: one of the opposites; none of them: all of the opposites.
  return (condition.kind === "all") === holds ? "and" : "or";
}

function leafText(leaf: Leaf, names: Names, holds: boolean): string {
  switch (leaf.kind) {
    case "compare":
      return comparedText(leaf, names, holds);
    case "changed": {
      const by = leaf.deadband > 0 ? ` by more than ${leaf.deadband}` : "";
      return `${fieldText(leaf.signal, names)} ${holds ? "changes" : "does not change"}${by}`;
    }
    case "received":
      return `${holds ? "a message" : "no message"} arrives on ${topicText(leaf.signal, names)}`;
    case "absent": {
      const silent = holds ? "is silent" : "is not silent";
      return `${topicText(leaf.signal, names)} ${silent} for ${secondsText(leaf.seconds)}`;
    }
    case "rate": {
      const slow = (leaf.below !== null) === holds;
      const topic = topicText({ topic: leaf.topic, type: leaf.type ?? "" }, names);
      return `${topic} comes ${slow ? "slower" : "faster"} than ${leaf.below ?? leaf.above ?? 0} Hz`;
    }
    case "callable":
      return `${spaced(leaf.name)} of the recipe ${holds ? "holds" : "does not hold"}`;
  }
}

function comparedText(leaf: Compare, names: Names, holds: boolean): string {
  const { signal, operator, value } = leaf;
  const component = componentOf(signal, names);
  if (component !== null && (operator === "==" || operator === "!=")) {
    const same = (operator === "==") === holds;
    const words = STATUS_WORDS[Number(value)];
    if (words !== undefined && same) return `${component} ${words}`;
    if (value === 0) return `${component} is not well`;
    if (words !== undefined) return `anything but: ${component} ${words}`;
  }
  const field = fieldText(signal, names);
  if (operator === "between") {
    const [low, high] = Array.isArray(value) ? value : [value, value];
    return `${field} ${holds ? "is" : "is not"} between ${low} and ${high}`;
  }
  const literal = Array.isArray(value)
    ? listText(value.map((each) => names.constant(signal, each) ?? valueText(each)))
    : (names.constant(signal, value) ?? valueText(value));
  const metres = isRange(signal) ? " m" : "";
  const about = leaf.tolerance > 0 ? `, give or take ${leaf.tolerance}` : "";
  return `${field} ${OPERATORS[operator][holds ? 0 : 1]} ${literal}${metres}${about}`;
}

/** The component that a status is of, as people call it; null where it is none. */
function componentOf(signal: Signal, names: Names): string | null {
  if (!STATUS.test(signal.type) || signal.path.join(".") !== "status") return null;
  const known = topicOf(names.graph, signal.topic)?.component;
  const own = known || bare(signal.topic).replace(/[/_]status$/, "");
  return own === bare(signal.topic) ? null : names.component(own);
}

const isRange = (signal: Signal): boolean =>
  TOPIC_WORDS[signal.type] === "laser scan" && signal.path[0] === "ranges";

function fieldText(signal: Signal, names: Names): string {
  if (isRange(signal) && signal.aggregate === "min") return "the nearest obstacle";
  const topic = topicText(signal, names);
  const field = spaced(signal.path.filter((part) => part !== "data").join(" "));
  const of = field === "" ? topic : `${field} of ${topic}`;
  switch (signal.aggregate) {
    case null:
      return of;
    case "len":
      return `the number of ${of}`;
    case "min":
      return `the smallest of ${of}`;
    case "max":
      return `the largest of ${of}`;
    case "mean":
      return `the mean of ${of}`;
    default:
      return `${signal.aggregate} of ${of}`;
  }
}

function topicText({ topic, type }: Pick<Signal, "topic" | "type">, names: Names): string {
  if (topic === "") return "…";
  const known = topicOf(names.graph, topic);
  const word = TOPIC_WORDS[known?.type ?? type];
  // Where there are several of a type, their names tell them apart.
  const alike = names.graph?.topics.filter((each) => each.type === (known?.type ?? type)) ?? [];
  return word !== undefined && alike.length < 2 ? `the ${word}` : spaced(bare(topic));
}

const spaced = (name: string): string => name.replaceAll(/[_/]+/g, " ");

/** One line for an action, with the names that people have for components. */
export function plainAction(action: Action, names: Names): string {
  switch (action.kind) {
    case "method":
      return actionText({ ...action, component: names.component(action.component) });
    case "lifecycle":
    case "reconfigure":
      return actionText({ ...action, component: names.component(action.component) });
    case "update_parameters":
      return `set ${listText(
        Object.entries(action.parameters).map(
          ([name, value]) =>
            `${spaced(name)} of ${names.component(action.component)} to ${valueText(value)}`,
        ),
      )}`;
    case "call_service":
      return action.type.endsWith("/StopRobot") ? "stop the robot" : actionText(action);
    case "publish":
      return `send a message on ${spaced(action.topic)}`;
    default:
      return actionText(action);
  }
}

/** What a component is called where nobody has told: `drive_manager` is "Drive manager". */
export const titleOf = (name: string): string => title(bare(name));
