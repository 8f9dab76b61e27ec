import type { Place } from "../api/types";
import { degreesText, pointText } from "../format";
import { t } from "../texts/text";

/** As the robot keeps them; it says so itself, too, to whoever does not ask this page. */
export const LONGEST_NAME = 40;
export const LONGEST_NOTE = 200;

/** From so many on a list is searched rather than read. */
export const SEARCH_FROM = 8;

const byName = new Intl.Collator(undefined, { numeric: true, sensitivity: "base" });

/** What two texts have in common for who searches: case and accents do not count. */
const plain = (text: string) => text.normalize("NFKD").replace(/\p{M}/gu, "").toLocaleLowerCase();

/** The places of the map of now in which every word that was typed occurs, by name. */
export function placesHere(places: readonly Place[], search = ""): Place[] {
  const words = plain(search).split(/\s+/).filter(Boolean);
  return places
    .filter((place) => place.here)
    .filter((place) => {
      const text = plain(`${place.name} ${place.note}`);
      return words.every((word) => text.includes(word));
    })
    .sort((a, b) => byName.compare(a.name, b.name));
}

/** Those of other maps: they are not gone to, but can be taken along or deleted. */
export function placesElsewhere(places: readonly Place[]): Place[] {
  return places
    .filter((place) => !place.here)
    .sort((a, b) => byName.compare(a.map.label, b.map.label) || byName.compare(a.name, b.name));
}

/** What is wrong with a name, in a sentence; null when nothing is that this page can tell. */
export function nameProblem(name: string, what: "place" | "zone" = "place"): string | null {
  const length = [...name.trim()].length;
  if (length === 0)
    return what === "zone" ? t("Give the zone a name.") : t("Give the place a name.");
  return length > LONGEST_NAME
    ? t("Use at most {most} characters, not {length}.", { most: LONGEST_NAME, length })
    : null;
}

export function noteProblem(note: string): string | null {
  const length = [...note.trim()].length;
  return length > LONGEST_NOTE
    ? t("Use at most {most} characters, not {length}.", { most: LONGEST_NOTE, length })
    : null;
}

export function poseText({ x, y, yaw }: Place["pose"]): string {
  const place = pointText(x, y);
  return yaw === null
    ? t("{place}, any heading", { place })
    : t("{place}, heading {degrees}", { place, degrees: degreesText(yaw) });
}

/** A goal is at a place when it is where that is, to within what both are written with. */
export function placeAt(
  places: readonly Place[],
  goal: { x: number; y: number; yaw: number | null },
): Place | null {
  const near = (a: number, b: number) => Math.abs(a - b) < 1e-3;
  return (
    places.find(
      ({ here, pose }) =>
        here &&
        near(pose.x, goal.x) &&
        near(pose.y, goal.y) &&
        (pose.yaw === null || goal.yaw === null
          ? pose.yaw === goal.yaw
          : near(Math.cos(pose.yaw - goal.yaw), 1)),
    ) ?? null
  );
}
