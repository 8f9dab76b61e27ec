/** Arguments of actions as one level of fields, and what may be taken from messages. */
import type { Condition, Graph, GraphField } from "../../api/ruleTypes";
import { bare } from "./actions";
import { leavesOf, pathText } from "./condition";
import type { ValueKind } from "./signals";

export type Values = Record<string, unknown>;

/** Nested objects as keys with dots: `{point: {x: 1}}` is `{"point.x": 1}`; the robot reads both. */
export function flatten(values: Values, at = ""): Values {
  const flat: Values = {};
  for (const [name, value] of Object.entries(values)) {
    const key = at === "" ? name : `${at}.${name}`;
    if (isObject(value) && Object.keys(value).length > 0) Object.assign(flat, flatten(value, key));
    else flat[key] = value;
  }
  return flat;
}

function isObject(value: unknown): value is Values {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

/** An argument that can be given: its name, and what sort of value it takes. */
export interface ArgumentField {
  name: string;
  kind: ValueKind;
  text: string;
  constants: Record<string, number>;
  initial: unknown;
}

/** The fields of a request, goal or message that can be set one by one. */
export function messageFields(graph: Graph | null, type: string): ArgumentField[] {
  return (graph?.types[type] ?? [])
    .filter((field) => field.path.every((step) => typeof step === "string"))
    .map((field) => ({
      name: field.text,
      kind: field.kind,
      text: "",
      constants: field.constants,
      initial: initialValue(field.kind),
    }));
}

function initialValue(kind: ValueKind): unknown {
  return { bool: false, int: 0, float: 0, text: "", list: [], message: "" }[kind];
}

const KINDS: [RegExp, ValueKind][] = [
  [/^bool/, "bool"],
  [/^(int|uint|byte)/, "int"],
  [/^(float|double|number)/, "float"],
  [/^(str|text)/, "text"],
  [/^(list|tuple|array|set)/, "list"],
];

/** The kind of a parameter or argument, from how the robot names it or from its value. */
export function kindOf(name: string, value: unknown): ValueKind {
  const lower = name.toLowerCase();
  for (const [pattern, kind] of KINDS) if (pattern.test(lower)) return kind;
  if (typeof value === "boolean") return "bool";
  if (typeof value === "number") return Number.isInteger(value) ? "int" : "float";
  if (typeof value === "string") return "text";
  if (Array.isArray(value)) return "list";
  return "message";
}

/** A part of a message that can stand for an argument. */
export interface Reference {
  value: string;
  label: string;
  kind: ValueKind;
}

/** What can be taken from the messages that a condition listens to. */
export function references(graph: Graph | null, condition: Condition): Reference[] {
  const topics = new Map<string, string>();
  for (const { leaf } of leavesOf(condition)) {
    if (leaf.kind === "callable") continue;
    const [name, type] =
      leaf.kind === "rate" ? [leaf.topic, leaf.type] : [leaf.signal.topic, leaf.signal.type];
    if (name !== "" && type) topics.set(bare(name), type);
  }
  const one = topics.size === 1;
  return [...topics].flatMap(([topic, type]) => {
    const root = one ? "$msg" : `$topic[/${topic}]`;
    const words = one ? "the message" : `/${topic}`;
    const fields = (graph?.types[type] ?? []).filter((field: GraphField) =>
      field.path.every((step) => typeof step === "string" || step >= 0),
    );
    return [
      { value: root, label: `${words}, whole`, kind: "message" as const },
      ...fields.map((field) => ({
        value: `${root}.${pathText(field.path)}`,
        label: `${pathText(field.path)} of ${words}`,
        kind: field.kind,
      })),
    ];
  });
}

export const isReference = (value: unknown): value is string =>
  typeof value === "string" && value.startsWith("$") && !value.startsWith("$$");

const NUMERIC: ReadonlySet<ValueKind> = new Set(["int", "float"]);

/** The references that can stand where a value of a kind is wanted. */
export function fittingReferences(all: Reference[], kind: ValueKind): Reference[] {
  return all.filter(
    (reference) => reference.kind === kind || (NUMERIC.has(reference.kind) && NUMERIC.has(kind)),
  );
}
