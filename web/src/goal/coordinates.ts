import type { GoalPoint } from "../api/types";

type Field = "x" | "y" | "heading";

/** Reads typed coordinates; a decimal comma is as good as a point, an empty heading is none. */
export function parseCoordinates(
  x: string,
  y: string,
  heading: string,
): { goal: GoalPoint | null; errors: Partial<Record<Field, string>> } {
  const errors: Partial<Record<Field, string>> = {};
  const read = (field: Field, text: string): number => {
    const value = Number(text.trim().replace(",", "."));
    if (text.trim() === "") errors[field] = "Needed: a number of metres";
    else if (!Number.isFinite(value)) errors[field] = `Not a number: ${text.trim()}`;
    return value;
  };
  const goal: GoalPoint = { x: read("x", x), y: read("y", y), yaw: null };
  if (heading.trim() !== "") goal.yaw = (read("heading", heading) * Math.PI) / 180;
  return { goal: Object.keys(errors).length === 0 ? goal : null, errors };
}
