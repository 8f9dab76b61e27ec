import type { Extra } from "../api/types";

/** Of one page, as the console takes them. */
export const MOST_EXTRAS = 8;

/** What the page says of layers that are no part of the stack. */
export const EXTRAS = {
  title: "More on this robot",
  enough: `${MOST_EXTRAS} of these at most: switch one off first.`,
  gone: "Nobody publishes it now.",
  waiting: "Nothing has come yet.",
} as const;

const KINDS: Record<Extra["kind"], string> = {
  path: "Path",
  poses: "Poses",
  markers: "Markers",
  cloud: "Point cloud",
  scan: "Laser scan",
  grid: "Map of cells",
  polygon: "Outline",
};

export const kindText = (extra: Extra): string => KINDS[extra.kind];

/** What is to be said of a layer that is on; null when it is simply there. */
export function extraNote(extra: Extra): string | null {
  if (extra.problem !== "") return extra.problem;
  if (extra.age === null) return EXTRAS.waiting;
  return extra.note === "" ? null : extra.note;
}
