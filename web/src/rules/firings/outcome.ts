import type { Firing } from "../../api/ruleTypes";
import type { Level } from "../../ui/StatusMark";
import { leftText } from "../model/words";

/** What came of it, in a word or two: `ok, 3.2 s`. */
export function outcomeText(firing: Firing): string {
  if (firing.kind !== "firing") {
    return firing.kind === "shadow" ? "shadow: did not act" : firing.kind;
  }
  if (firing.ended === null) return "running";
  const took = leftText(firing.ended - firing.time);
  return firing.ok ? `ok, ${took}` : `failed, ${took}`;
}

export function outcomeLevel(firing: Firing): Level {
  if (firing.kind !== "firing") return "unknown";
  return firing.ok === false ? "failed" : "healthy";
}
