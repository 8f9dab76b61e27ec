import { degreesText } from "../format";

export type FloorPoint = readonly [number, number];

/** `42 cm`, `3.42 m`, `120.5 m`: to the centimetre, which is what a map can tell. */
export function lengthText(metres: number): string {
  if (metres < 0.995) return `${Math.round(metres * 100)} cm`;
  return metres < 99.995 ? `${metres.toFixed(2)} m` : `${metres.toFixed(1)} m`;
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
  if (points.length === 2) return `${lengthText(apart(first, last))}, to ${heading}`;
  return [
    `${lengthText(wholeLength(points))} along ${points.length} points`,
    `${lengthText(apart(before, last))} the last, to ${heading}`,
    `${lengthText(apart(first, last))} straight from the first`,
  ].join(" · ");
}
