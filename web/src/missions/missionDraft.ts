import type { Mission, MissionSave } from "../api/types";
import { readKept, writeKept } from "../kept";

/** What a form begins with: the mission as it is, or an empty one. */
export function beginning(mission: Mission | null): MissionSave {
  if (mission === null) {
    const nothing = { rounds: 1, attempts: 1, on_failure: "pause", schedule: null } as const;
    return { name: "", waypoints: [], ...nothing };
  }
  const { name, waypoints, rounds, attempts, on_failure, schedule } = mission;
  return { name, waypoints, rounds, attempts, on_failure, schedule };
}

interface Kept {
  /** What it began from: a draft of what somebody else has changed meanwhile would undo that. */
  from: MissionSave;
  draft: MissionSave;
}

const keyOf = (mission: Mission | null) => `kompass.mission.${mission?.id ?? "new"}`;

/** What was typed and neither saved nor left; null where nothing is kept, or cannot be read. */
export function keptDraft(mission: Mission | null): MissionSave | null {
  let kept: Partial<Kept> | null;
  try {
    kept = JSON.parse(readKept(keyOf(mission)) || "null");
  } catch {
    return null;
  }
  const { from, draft } = kept ?? {};
  if (from === undefined || !Array.isArray(draft?.waypoints)) return null;
  return same(from, beginning(mission)) ? draft : null;
}

/** Keep what was typed until it is saved or left. */
export function keepDraft(mission: Mission | null, draft: MissionSave): void {
  const from = beginning(mission);
  const kept: Kept = { from, draft };
  writeKept(keyOf(mission), same(from, draft) ? "" : JSON.stringify(kept));
}

/** It is saved, or nobody wants it any more. */
export function dropDraft(mission: Mission | null): void {
  writeKept(keyOf(mission), "");
}

function same(one: MissionSave, other: MissionSave): boolean {
  return JSON.stringify(one) === JSON.stringify(other);
}
