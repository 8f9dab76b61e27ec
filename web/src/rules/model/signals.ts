/** What can be asked of a topic: its fields, the comparisons that fit them, and their literals. */
import type {
  Aggregate,
  Compare,
  Graph,
  GraphField,
  GraphTopic,
  Literal,
  Operator,
  Signal,
} from "../../api/ruleTypes";
import { bare } from "./actions";
import { pathText } from "./condition";

export type ValueKind = "bool" | "int" | "float" | "text" | "message" | "list";

/** One thing to compare: a field, or what is made of a list. */
export interface FieldChoice {
  key: string;
  label: string;
  path: (string | number)[];
  aggregate: Aggregate | null;
  kind: ValueKind;
  /** Kind of the items of a list; empty where it is none. */
  element: string;
  constants: Record<string, number>;
}

export function topicOf(graph: Graph | null, name: string): GraphTopic | null {
  return graph?.topics.find((topic) => bare(topic.name) === bare(name)) ?? null;
}

const NUMBERS = new Set(["int", "float"]);

/** Lists that have a better name than "smallest of". */
const WORDS: Record<string, Partial<Record<Aggregate, string>>> = {
  "sensor_msgs/msg/LaserScan.ranges": {
    min: "nearest obstacle",
    max: "farthest range",
    mean: "mean range",
  },
};
const AGGREGATE_WORDS: Record<Aggregate, (field: string) => string> = {
  min: (field) => `smallest of ${field}`,
  max: (field) => `largest of ${field}`,
  mean: (field) => `mean of ${field}`,
  len: (field) => `number of ${field}`,
  any: (field) => `any of ${field}`,
  all: (field) => `all of ${field}`,
};

/** The fields of a type in the order in which one looks for them: headers last. */
export function fieldChoices(graph: Graph | null, type: string): FieldChoice[] {
  const fields = graph?.types[type] ?? [];
  const choices = fields.flatMap((field): FieldChoice[] =>
    field.kind === "list" ? listChoices(type, field) : [plainChoice(field)],
  );
  const header = (choice: FieldChoice) =>
    choice.path.includes("header") || choice.path.includes("stamp") ? 1 : 0;
  const whole = (choice: FieldChoice) => (choice.kind === "message" ? 1 : 0);
  return choices.sort((a, b) => header(a) - header(b) || whole(a) - whole(b));
}

function plainChoice(field: GraphField): FieldChoice {
  return {
    key: fieldKey(field.path, null),
    label: field.text,
    path: field.path,
    aggregate: null,
    kind: field.kind,
    element: field.element,
    constants: field.constants,
  };
}

function listChoices(type: string, field: GraphField): FieldChoice[] {
  const numbers = NUMBERS.has(field.element);
  const made: Aggregate[] = numbers
    ? ["min", "max", "mean", "len"]
    : field.element === "bool"
      ? ["any", "all", "len"]
      : ["len"];
  const words = WORDS[`${type}.${field.text}`];
  const aggregates = made.map((aggregate): FieldChoice => {
    const plain = `${aggregate}(${field.text})`;
    const word = words?.[aggregate] ?? AGGREGATE_WORDS[aggregate](field.text);
    return {
      key: fieldKey(field.path, aggregate),
      label: `${word} – ${plain}`,
      path: field.path,
      aggregate,
      kind:
        aggregate === "any" || aggregate === "all" ? "bool" : aggregate === "len" ? "int" : "float",
      element: "",
      constants: {},
    };
  });
  return field.element === "message" ? aggregates : [...aggregates, plainChoice(field)];
}

export function fieldKey(path: readonly (string | number)[], aggregate: Aggregate | null): string {
  return `${aggregate ?? ""}|${pathText(path)}`;
}

/** The choice that a signal has made, with what is known of it; null when nothing is. */
export function chosenField(graph: Graph | null, signal: Signal): FieldChoice | null {
  const key = fieldKey(signal.path, signal.aggregate);
  return fieldChoices(graph, signal.type).find((choice) => choice.key === key) ?? null;
}

interface OperatorChoice {
  value: Operator;
  label: string;
}

const is: OperatorChoice[] = [
  { value: "==", label: "is" },
  { value: "!=", label: "is not" },
];
const order: OperatorChoice[] = [
  { value: "<", label: "< less than" },
  { value: "<=", label: "≤ at most" },
  { value: ">", label: "> more than" },
  { value: ">=", label: "≥ at least" },
];
const among: OperatorChoice[] = [
  { value: "in", label: "one of" },
  { value: "not_in", label: "none of" },
];
const within: OperatorChoice[] = [
  { value: "contains", label: "contains" },
  { value: "not_contains", label: "does not contain" },
  { value: "contains_any", label: "contains any of" },
  { value: "not_contains_any", label: "contains none of" },
  { value: "contains_all", label: "contains all of" },
  { value: "not_contains_all", label: "lacks some of" },
];

/** The comparisons that make sense for a value. */
export function operatorsFor(
  field: Pick<FieldChoice, "kind" | "constants"> | null,
): OperatorChoice[] {
  switch (field?.kind) {
    case "bool":
      return is;
    case "int":
    case "float": {
      const between: OperatorChoice = { value: "between", label: "between" };
      return Object.keys(field.constants).length > 0
        ? [...is, ...among, ...order, between]
        : [...order, ...is, between, ...among];
    }
    case "text":
      return [...is, ...within.slice(0, 2), ...among];
    case "list":
      return [...within, ...is];
    default:
      return [...is, ...order, ...among, ...within, { value: "between", label: "between" }];
  }
}

const LISTS: ReadonlySet<Operator> = new Set([
  "in",
  "not_in",
  "between",
  "contains_any",
  "contains_all",
  "not_contains_any",
  "not_contains_all",
]);

/** Whether an operator compares with several values. */
export const takesList = (operator: Operator): boolean => LISTS.has(operator);

/** The literal, as far as it can be kept, in the shape that operator and kind of value need. */
export function fitLiteral(operator: Operator, kind: ValueKind | null, value: Literal): Literal {
  const scalars = (Array.isArray(value) ? value : [value]).map((item) => fitScalar(kind, item));
  const first = scalars[0] ?? emptyScalar(kind);
  if (operator === "between") {
    const low = typeof first === "number" ? first : 0;
    const high = typeof scalars[1] === "number" ? scalars[1] : low;
    return [Math.min(low, high), Math.max(low, high)];
  }
  if (takesList(operator) || (kind === "list" && (operator === "==" || operator === "!="))) {
    return Array.isArray(value) ? scalars : [first];
  }
  return first;
}

function fitScalar(kind: ValueKind | null, value: boolean | number | string) {
  switch (kind) {
    case "bool":
      return typeof value === "boolean" ? value : true;
    case "int":
    case "float": {
      const number = typeof value === "number" ? value : Number.parseFloat(String(value));
      const finite = Number.isFinite(number) ? number : 0;
      return kind === "int" ? Math.round(finite) : finite;
    }
    case "text":
      return String(value);
    default:
      return value;
  }
}

function emptyScalar(kind: ValueKind | null): boolean | number | string {
  if (kind === "bool") return true;
  return kind === "text" || kind === null ? "" : 0;
}

/** Seconds after which a value of a topic should no longer count; null where it never ages. */
export function sensibleTimeout(topic: GraphTopic | null): number | null {
  if (topic?.latched) return null;
  if (topic?.rate == null || topic.rate <= 0) return 1;
  // Three messages in a row lost, and never so short that a busy moment makes it unknown.
  return Math.max(1, Math.ceil(30 / topic.rate) / 10);
}

/** The same comparison of another field: operator and literal are kept where they fit. */
export function withField(leaf: Compare, field: FieldChoice): Compare {
  const fitting = operatorsFor(field).map(({ value }) => value);
  const operator = fitting.includes(leaf.operator) ? leaf.operator : (fitting[0] ?? "==");
  const constant = Object.values(field.constants)[0];
  const literal = constant !== undefined && leaf.value === 0 ? constant : leaf.value;
  return {
    ...leaf,
    signal: { ...leaf.signal, path: field.path, aggregate: field.aggregate },
    operator,
    value: fitLiteral(operator, field.kind, literal),
    tolerance: operator === "==" || operator === "!=" ? leaf.tolerance : 0,
  };
}
