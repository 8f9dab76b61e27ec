import type { Zone } from "../api/types";

export type Corner = readonly [number, number];

/** Corners as the console sends them. */
export const asCorners = (sent: readonly (readonly number[])[]): Corner[] =>
  sent.map(([x = 0, y = 0]) => [x, y]);

/** What a zone asks of the robot. */
export const ruleText = (zone: Pick<Zone, "kind" | "speed">): string =>
  zone.kind === "keep_out" ? "Keep out" : `At most ${zone.speed ?? "?"} m/s`;

/** As it is written on the map. */
export const labelText = (zone: Pick<Zone, "name" | "kind" | "speed">): string =>
  zone.kind === "keep_out" ? `${zone.name}: keep out` : `${zone.name}: ${zone.speed} m/s`;

/** Corners as a person types them: x and y, a line each. */
export const cornersText = (corners: readonly Corner[]): string =>
  corners.map(([x, y]) => `${x}, ${y}`).join("\n");

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
      return { corners, problem: `Line ${n + 1}: give x and y in metres, as "1.5, -0.2"` };
    }
    corners.push([x ?? 0, y ?? 0]);
  }
  return { corners, problem: null };
}

/** The limit that somebody has typed, m/s; null when it is none. */
export function readSpeed(text: string): number | null {
  const speed = Number(text.trim().replace(",", "."));
  return text.trim() !== "" && Number.isFinite(speed) && speed > 0 ? speed : null;
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
  if (robot) told.push("The robot stands in it: then it is got out by hand only.");
  if (first !== undefined && others.length === 0) told.push(`The place ${first} lies in it.`);
  if (others.length > 0)
    told.push(`The places ${places.slice(0, -1).join(", ")} and ${others.at(-1)} lie in it.`);
  return told.length === 0 ? null : told.join(" ");
}
