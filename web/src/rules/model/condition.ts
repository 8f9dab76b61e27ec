/** The tree of a condition: reading, changing and telling it. Nothing here changes its input. */
import type { Condition, Group, Leaf, Literal, Signal, TreePath } from "../../api/ruleTypes";

export function isGroup(condition: Condition): condition is Group {
  return condition.kind === "all" || condition.kind === "any";
}

function childrenOf(condition: Condition): readonly Condition[] {
  if (isGroup(condition)) return condition.conditions;
  return condition.kind === "not" ? [condition.condition] : [];
}

/** The leaves from left to right, each with its path; as the robot's own engine counts them. */
export function leavesOf(
  condition: Condition,
  at: TreePath = [],
): { path: TreePath; leaf: Leaf }[] {
  if (isGroup(condition) || condition.kind === "not") {
    return childrenOf(condition).flatMap((child, index) => leavesOf(child, [...at, index]));
  }
  return [{ path: at, leaf: condition }];
}

export function nodeAt(condition: Condition, path: TreePath): Condition | null {
  const [first, ...rest] = path;
  if (first === undefined) return condition;
  const child = childrenOf(condition)[first];
  return child === undefined ? null : nodeAt(child, rest);
}

/** The tree with another node at `path`. */
export function replaceAt(condition: Condition, path: TreePath, next: Condition): Condition {
  const [first, ...rest] = path;
  if (first === undefined) return next;
  if (condition.kind === "not") {
    return { ...condition, condition: replaceAt(condition.condition, rest, next) };
  }
  if (!isGroup(condition)) return condition;
  return {
    ...condition,
    conditions: condition.conditions.map((child, index) =>
      index === first ? replaceAt(child, rest, next) : child,
    ),
  };
}

/** The tree without the node at `path`, or null when nothing is left. Emptied groups go too. */
export function removeAt(condition: Condition, path: TreePath): Condition | null {
  const [first, ...rest] = path;
  if (first === undefined) return null;
  if (condition.kind === "not") {
    const inner = removeAt(condition.condition, rest);
    return inner === null ? null : { ...condition, condition: inner };
  }
  if (!isGroup(condition)) return condition;
  const kept = condition.conditions.flatMap((child, index) => {
    if (index !== first) return [child];
    const left = removeAt(child, rest);
    return left === null ? [] : [left];
  });
  return kept.length === 0 ? null : { ...condition, conditions: kept };
}

/** Whether nothing has been chosen yet: a comparison of no topic. */
export const isBlank = (condition: Condition): boolean =>
  condition.kind === "compare" && condition.signal.topic === "";

/** The tree with one more condition beside the node at `path`, inside it when it is a group. */
export function addAt(condition: Condition, path: TreePath, added: Condition): Condition {
  const node = nodeAt(condition, path);
  if (node === null) return condition;
  return replaceAt(
    condition,
    path,
    isGroup(node)
      ? { ...node, conditions: [...node.conditions, added] }
      : { kind: "all", conditions: [node, added] },
  );
}

/** Turns `not` on or off for the node at `path`. */
export function toggleNot(condition: Condition, path: TreePath): Condition {
  const node = nodeAt(condition, path);
  if (node === null) return condition;
  return replaceAt(
    condition,
    path,
    node.kind === "not" ? node.condition : { kind: "not", condition: node },
  );
}

/** Where a node is in a rule, as findings name it: `event.condition.conditions[0]`. */
export function fieldOf(root: string, condition: Condition, path: TreePath): string {
  let text = root;
  let node: Condition | undefined = condition;
  for (const index of path) {
    if (node === undefined) break;
    text += node.kind === "not" ? ".condition" : `.conditions[${index}]`;
    node = childrenOf(node)[index];
  }
  return text;
}

export const samePath = (a: TreePath, b: TreePath): boolean =>
  a.length === b.length && a.every((step, index) => step === b[index]);

/** A path in a message as one writes it: `poses[0].position.x`. */
export function pathText(path: readonly (string | number)[]): string {
  return path.reduce<string>(
    (text, part) =>
      typeof part === "number" ? `${text}[${part}]` : text === "" ? part : `${text}.${part}`,
    "",
  );
}

export function signalText(signal: Signal): string {
  const path = pathText(signal.path);
  const joint = path === "" || path.startsWith("[") ? "" : ".";
  const text = `${signal.topic || "…"}${joint}${path}`;
  return signal.aggregate === null ? text : `${signal.aggregate}(${text})`;
}

/** What a message type calls a number; null where it has no name for it. */
export type ConstantName = (signal: Signal, literal: Literal) => string | null;

const noNames: ConstantName = () => null;

/** A condition in one line, worded as the robot words it. */
export function conditionText(condition: Condition, names: ConstantName = noNames): string {
  switch (condition.kind) {
    case "all":
    case "any":
      return condition.conditions
        .map((child) => inner(child, condition, names))
        .join(condition.kind === "all" ? " and " : " or ");
    case "not":
      return `not ${inner(condition.condition, condition, names)}`;
    case "compare": {
      const signal = signalText(condition.signal);
      if (condition.operator === "between" && Array.isArray(condition.value)) {
        const [low, high] = condition.value;
        return `${literalText(low ?? "")} <= ${signal} <= ${literalText(high ?? "")}`;
      }
      const text = `${signal} ${condition.operator.replaceAll("_", " ")} ${names(condition.signal, condition.value) ?? literalText(condition.value)}`;
      return condition.tolerance > 0 ? `${text} (±${condition.tolerance})` : text;
    }
    case "changed":
      return `${signalText(condition.signal)} changed${
        condition.deadband > 0 ? ` by more than ${condition.deadband}` : ""
      }`;
    case "received":
      return `${signalText(condition.signal)} received`;
    case "absent":
      return `${signalText(condition.signal)} absent for ${condition.seconds} s`;
    case "rate": {
      const way = condition.below !== null ? "below" : "above";
      const bound = condition.below ?? condition.above ?? 0;
      return `rate of ${condition.topic || "…"} ${way} ${bound} Hz over ${condition.window} s`;
    }
    case "callable":
      return `${condition.name}()`;
  }
}

function inner(condition: Condition, outer: Condition, names: ConstantName): string {
  const text = conditionText(condition, names);
  const many = isGroup(condition) && condition.conditions.length > 1;
  const spaced = outer.kind === "not" && condition.kind !== "not" && condition.kind !== "callable";
  return spaced || (many && condition.kind !== outer.kind) ? `(${text})` : text;
}

function literalText(value: Literal): string {
  if (Array.isArray(value)) return `[${value.map(literalText).join(", ")}]`;
  return typeof value === "string" ? `"${value}"` : String(value);
}
