import { chosen } from "./chosen";

/** How lengths and speeds are shown and typed. What is sent and stored is metric, always. */
export const UNITS = ["metric", "imperial"] as const;
export type Units = (typeof UNITS)[number];

/** The units of the page. Metric until somebody chooses others: a browser's language tells of no floor. */
export const units = chosen("kompass-units", UNITS, () => "metric");

/** Exactly, since 1959. */
export const METRES_PER_FOOT = 0.3048;
const INCHES_PER_FOOT = 12;

/** The unit of a length, of a speed. */
export const lengthUnit = (): "m" | "ft" => (units.get() === "metric" ? "m" : "ft");
export const speedUnit = (): "m/s" | "ft/s" => (units.get() === "metric" ? "m/s" : "ft/s");

/** Metres in the chosen unit of length, or m/s in that of speed. */
export const shown = (metric: number): number =>
  units.get() === "metric" ? metric : metric / METRES_PER_FOOT;

/**
 * What somebody typed in the chosen unit, in m or m/s: 1.5 ft are 0.4572 m, and not a hair beside
 * it, which is what the product of two binary fractions would be.
 */
export const typed = (figure: number): number =>
  units.get() === "metric" ? figure : Number((figure * METRES_PER_FOOT).toPrecision(12));

/** Whole feet, and the inches that are left: 1.9 m are 6 ft 3 in. */
export function feetAndInches(metres: number): { feet: number; inches: number } {
  const inches = Math.round((metres / METRES_PER_FOOT) * INCHES_PER_FOOT);
  return { feet: Math.floor(inches / INCHES_PER_FOOT), inches: inches % INCHES_PER_FOOT };
}

/**
 * A length or speed as it stands in a field, in as few digits as `typed` makes the same of. With a
 * point in every language: that is how it is typed, too.
 */
export function fieldText(metric: number): string {
  if (units.get() === "metric") return String(metric);
  for (let digits = 3; digits < 15; digits++) {
    const text = String(Number(shown(metric).toPrecision(digits)));
    if (typed(Number(text)) === metric) return text;
  }
  return String(Number(shown(metric).toPrecision(15)));
}
