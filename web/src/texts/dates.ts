import { locale } from "./language";

/** Dates and times in the language of the page, on a clock of 24 hours. Epoch seconds. */

const kept = new Map<string, Intl.DateTimeFormat>();

function format(options: Intl.DateTimeFormatOptions): Intl.DateTimeFormat {
  const key = `${locale()} ${JSON.stringify(options)}`;
  let found = kept.get(key);
  if (found === undefined) {
    found = new Intl.DateTimeFormat(locale(), options);
    kept.set(key, found);
  }
  return found;
}

/** `08:15` or, medium, `08:15:30`. */
export const timeText = (time: number, style: "short" | "medium"): string =>
  format({ timeStyle: style, hour12: false }).format(time * 1000);

const DAY = { day: "numeric", month: "short" } as const;
const MINUTE = { hour: "2-digit", minute: "2-digit", hour12: false } as const;

/** A moment: its day, its minute, or both. */
export function dateText(time: number, part: "both" | "day" | "minute" = "both"): string {
  const options = { both: { ...DAY, ...MINUTE }, day: DAY, minute: MINUTE }[part];
  return format(options).format(time * 1000);
}

/** `Monday, 24 November`. */
export const dayName = (time: number): string =>
  format({ weekday: "long", day: "numeric", month: "long" }).format(time * 1000);

/** Day, month, year and time to the second. */
export const wholeDateText = (time: number): string =>
  format({ dateStyle: "medium", timeStyle: "medium", hour12: false }).format(time * 1000);

/** A day of the week; 0 is a Monday. */
export function weekdayText(day: number, length: "short" | "long"): string {
  // The first of January 2024 was a Monday; noon, so that no zone of time makes it another day.
  return format({ weekday: length }).format(new Date(2024, 0, 1 + day, 12));
}
