import type { Scenario } from "../../api/drillTypes";
import { isRecord } from "../../api/errors";

/** Drawn drives or one of the person's own, how often, and the own one where there is one. */
export interface DrillWish {
  own: boolean;
  count: string;
  scenario: Scenario | null;
}

/** Of this page alone, as long as its tab is open: also when it is loaded again. */
const KEPT = "kompass.drill";
const NOTHING: DrillWish = { own: false, count: "20", scenario: null };

export const keepWish = (wish: DrillWish): void =>
  sessionStorage.setItem(KEPT, JSON.stringify(wish));

/** What was wished before the page was loaded again; a page of another release may have kept it. */
export function keptWish(): DrillWish {
  let kept: unknown;
  try {
    kept = JSON.parse(sessionStorage.getItem(KEPT) ?? "null");
  } catch {
    return NOTHING;
  }
  return isWish(kept) ? kept : NOTHING;
}

const isWish = (kept: unknown): kept is DrillWish =>
  isRecord(kept) &&
  typeof kept.own === "boolean" &&
  typeof kept.count === "string" &&
  (kept.scenario === null || isScenario(kept.scenario));

const isScenario = (kept: unknown): kept is Scenario =>
  isRecord(kept) && ["goals", "faults", "operators"].every((each) => Array.isArray(kept[each]));
