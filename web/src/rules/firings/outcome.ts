import type { Firing } from "../../api/ruleTypes";
import { language } from "../../texts/language";
import { textIn } from "../../texts/text";
import type { Level } from "../../ui/StatusMark";
import { leftText } from "../model/words";

/** What came of it, in a word or two: `ok, 3.2 s`. */
export function outcomeText(firing: Firing, of = language.get()): string {
  if (firing.kind !== "firing") {
    return firing.kind === "shadow" ? textIn(of, "shadow: did not act") : textIn(of, firing.kind);
  }
  if (firing.ended === null) return textIn(of, "running");
  const took = leftText(firing.ended - firing.time);
  return firing.ok ? textIn(of, "ok, {took}", { took }) : textIn(of, "failed, {took}", { took });
}

export function outcomeLevel(firing: Firing): Level {
  if (firing.kind !== "firing") return "unknown";
  return firing.ok === false ? "failed" : "healthy";
}
