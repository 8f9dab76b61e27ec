import type { Zone } from "../api/types";
import { listText, speedText } from "../format";
import { t } from "../texts/text";
import { fieldText, typed, units } from "../texts/units";

export type Corner = readonly [number, number];

/** Corners as the console sends them. */
export const asCorners = (sent: readonly (readonly number[])[]): Corner[] =>
  sent.map(([x = 0, y = 0]) => [x, y]);

const limitText = (speed: number | null | undefined): string =>
  speed == null ? "?" : speedText(speed);

/** What a zone asks of the robot. */
export const ruleText = (zone: Pick<Zone, "kind" | "speed">): string =>
  zone.kind === "keep_out" ? t("Keep out") : t("At most {speed}", { speed: limitText(zone.speed) });

/** As it is written on the map. */
export const labelText = (zone: Pick<Zone, "name" | "kind" | "speed">): string =>
  zone.kind === "keep_out"
    ? t("{name}: keep out", { name: zone.name })
    : `${zone.name}: ${limitText(zone.speed)}`;

/** Corners as a person types them, in the chosen unit of length: x and y, a line each. */
export const cornersText = (corners: readonly Corner[]): string =>
  corners.map(([x, y]) => `${fieldText(x)}, ${fieldText(y)}`).join("\n");

/** The corners that somebody has typed, or what is wrong with them. */
export function readCorners(text: string): { corners: Corner[]; problem: string | null } {
  const corners: Corner[] = [];
  for (const [n, line] of text.split("\n").entries()) {
    if (line.trim() === "") continue;
    const numbers = line
      .trim()
      .split(/[\s,;]+/)
      .map(Number);
    const [x, y] = numbers;
    if (numbers.length !== 2 || !Number.isFinite(x) || !Number.isFinite(y)) {
      const problem =
        units.get() === "metric"
          ? t('Line {n}: give x and y in metres, as "1.5, -0.2"', { n: n + 1 })
          : t('Line {n}: give x and y in feet, as "1.5, -0.2"', { n: n + 1 });
      return { corners, problem };
    }
    corners.push([typed(x ?? 0), typed(y ?? 0)]);
  }
  return { corners, problem: null };
}

/** The limit that somebody has typed in the chosen unit, in m/s; null when it is none. */
export function readSpeed(text: string): number | null {
  const speed = Number(text.trim().replace(",", "."));
  return text.trim() !== "" && Number.isFinite(speed) && speed > 0 ? typed(speed) : null;
}

/** The corners after a press on the floor, or a drag, which makes a rectangle of nothing. */
export function drawn(corners: readonly Corner[], start: Corner, end: Corner | null): Corner[] {
  if (end === null || corners.length > 0) return [...corners, end ?? start];
  return [start, [end[0], start[1]], end, [start[0], end[1]]];
}

/** What a keep-out zone would shut in, as it is drawn now; null when that is nothing. */
export function shutInText(robot: boolean, places: readonly string[]): string | null {
  const [first, ...others] = places;
  const told: string[] = [];
  if (robot) told.push(t("The robot stands in it: then it is got out by hand only."));
  if (first !== undefined && others.length === 0)
    told.push(t("The place {first} lies in it.", { first }));
  if (others.length > 0) told.push(t("The places {names} lie in it.", { names: listText(places) }));
  return told.length === 0 ? null : told.join(" ");
}
