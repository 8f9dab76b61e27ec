import type { GoalCheck, GoalPoint } from "../api/types";
import type { Considered } from "../scene/flat/paint";

type Point = readonly [number, number];

/** A drag that is shorter on the floor has no direction, m. */
const SHORTEST_DRAG = 0.05;

/** The goal that a press on the floor means, and a release there when it was a drag. */
export function pointOf([x, y]: Point, end: Point | null): GoalPoint {
  const [dx, dy] = end === null ? [0, 0] : [end[0] - x, end[1] - y];
  return { x, y, yaw: Math.hypot(dx, dy) > SHORTEST_DRAG ? Math.atan2(dy, dx) : null };
}

/**
 * What the map shows of an answer: the goal and the way to it; of a refused one, the place itself and
 * the nearest that can be reached.
 */
export function consideredOf(check: GoalCheck | null): Considered | null {
  if (check === null || check.reason === "above_horizon") return null;
  const { ok, x, y, yaw, nearest, way } = check;
  if (ok) return { mark: { x, y, yaw }, way, refused: null };
  return { mark: nearest === null ? null : { ...nearest, yaw }, way: [], refused: { x, y } };
}
