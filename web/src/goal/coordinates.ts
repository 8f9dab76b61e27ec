import type { GoalPoint } from "../api/types";
import { t } from "../texts/text";
import { typed, units } from "../texts/units";

type Field = "x" | "y" | "heading";

/**
 * Reads typed coordinates, x and y in the chosen unit of length; a decimal comma is as good as a
 * point, an empty heading is none.
 */
export function parseCoordinates(
  x: string,
  y: string,
  heading: string,
): { goal: GoalPoint | null; errors: Partial<Record<Field, string>> } {
  const errors: Partial<Record<Field, string>> = {};
  const read = (field: Field, text: string): number => {
    const value = Number(text.trim().replace(",", "."));
    if (text.trim() === "")
      errors[field] =
        units.get() === "metric" ? t("Needed: a number of metres") : t("Needed: a number of feet");
    else if (!Number.isFinite(value))
      errors[field] = t("Not a number: {text}", { text: text.trim() });
    return value;
  };
  const goal: GoalPoint = { x: typed(read("x", x)), y: typed(read("y", y)), yaw: null };
  if (heading.trim() !== "") goal.yaw = (read("heading", heading) * Math.PI) / 180;
  return { goal: Object.keys(errors).length === 0 ? goal : null, errors };
}
