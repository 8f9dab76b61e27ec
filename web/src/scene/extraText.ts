import type { Extra } from "../api/types";
import { type Phrase, t } from "../texts/text";
import { told } from "../texts/told";

/** Of one page, as the console takes them. */
export const MOST_EXTRAS = 8;

const KINDS: Record<Extra["kind"], Phrase> = {
  path: "Path",
  poses: "Poses",
  markers: "Markers",
  cloud: "Point cloud",
  scan: "Laser scan",
  grid: "Map of cells",
  polygon: "Outline",
};

export const kindText = (extra: Extra): string => t(KINDS[extra.kind]);

/** What is to be said of a layer that is on; null when it is simply there. */
export function extraNote(extra: Extra): string | null {
  if (extra.problem !== "") return told(extra.problem);
  if (extra.age === null) return t("Nothing has come yet.");
  return extra.note === "" ? null : told(extra.note);
}
