import { degreesText, fixed } from "../format";
import { t } from "../texts/text";
import { feetAndInches, units } from "../texts/units";

export type FloorPoint = readonly [number, number];

/** `42 cm`, `3.42 m`, `120.5 m`, `11 ft 3 in`: to the centimetre or inch, which is what a map can tell. */
export function lengthText(metres: number): string {
  if (units.get() === "imperial") {
    const { feet, inches } = feetAndInches(metres);
    return feet === 0 ? `${inches} in` : `${feet} ft ${inches} in`;
  }
  if (metres < 0.995) return `${Math.round(metres * 100)} cm`;
  return metres < 99.995 ? `${fixed(metres, 2)} m` : `${fixed(metres, 1)} m`;
}

const apart = (from: FloorPoint, to: FloorPoint): number =>
  Math.hypot(to[0] - from[0], to[1] - from[1]);

/** Along all the points, m. */
export const wholeLength = (points: readonly FloorPoint[]): number =>
  points.reduce((sum, point, i) => sum + (i === 0 ? 0 : apart(points[i - 1] ?? point, point)), 0);

/** What was measured, in a line; null as long as there is nothing between two points. */
export function measuredText(points: readonly FloorPoint[]): string | null {
  const [first, last, before] = [points[0], points.at(-1), points.at(-2)];
  if (first === undefined || last === undefined || before === undefined) return null;
  const heading = degreesText(Math.atan2(last[1] - before[1], last[0] - before[0]));
  if (points.length === 2)
    return t("{length}, to {heading}", { length: lengthText(apart(first, last)), heading });
  return [
    t("{length} along {n} points", { length: lengthText(wholeLength(points)), n: points.length }),
    t("{length} the last, to {heading}", { length: lengthText(apart(before, last)), heading }),
    t("{length} straight from the first", { length: lengthText(apart(first, last)) }),
  ].join(" · ");
}
