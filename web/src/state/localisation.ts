import type { Localisation } from "../api/types";
import { type Phrase, t } from "../texts/text";
import type { Level } from "../ui/StatusMark";

/** A scan that is older says nothing of where the robot is now, s. */
const OLD_S = 3;

const UNKNOWN: Record<NonNullable<Localisation["problem"]>, Phrase> = {
  no_map: "There is no map to compare the scan with.",
  no_scan: "There is no laser scan to compare with the map.",
  no_pose: "The robot does not say where it is.",
  too_little: "Too little of what the robot sees is on the map to compare them.",
};

/** What to do for a robot that may be elsewhere. */
export const SET_ITS_PLACE: Phrase =
  "The robot may not be where it thinks, or things around it are not on the map. Set its place: the tool Locate, or O.";

export interface FitTold {
  level: Level;
  /** `97 %`, or a dash while it is unknown. */
  figure: string;
  sentence: string;
}

export const percentText = (share: number): string => `${Math.round(100 * share)} %`;

/** How well the scan fits the map, in words. */
export function mapFit({ agreement, age, lost, problem }: Localisation, elapsed: number): FitTold {
  if (agreement === null) {
    return { level: "unknown", figure: "–", sentence: t(UNKNOWN[problem ?? "too_little"]) };
  }
  const figure = percentText(agreement);
  if ((age ?? 0) + elapsed > OLD_S) {
    return { level: "unknown", figure: "–", sentence: t(UNKNOWN.no_scan) };
  }
  if (lost) {
    return {
      level: "degraded",
      figure,
      sentence: `${t("Scan and map agree {figure}.", { figure })} ${t(SET_ITS_PLACE)}`,
    };
  }
  return { level: "healthy", figure, sentence: t("Scan and map agree {figure}.", { figure }) };
}
