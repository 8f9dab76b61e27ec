import { type Language, language, locale } from "./language";
import { textIn } from "./text";

/**
 * Dates and times on a clock of 24 hours, in the language of the page or in one that is asked for.
 * Epoch seconds.
 */

const kept = new Map<string, Intl.DateTimeFormat>();

function format(of: Language, options: Intl.DateTimeFormatOptions): Intl.DateTimeFormat {
  const key = `${locale(of)} ${JSON.stringify(options)}`;
  let found = kept.get(key);
  if (found === undefined) {
    found = new Intl.DateTimeFormat(locale(of), options);
    kept.set(key, found);
  }
  return found;
}

/** `08:15` or, medium, `08:15:30`. */
export const timeText = (time: number, style: "short" | "medium", of = language.get()): string =>
  format(of, { timeStyle: style, hour12: false }).format(time * 1000);

export const clockText = (time: number, of = language.get()): string =>
  timeText(time, "medium", of);

const DAY = { day: "numeric", month: "short" } as const;
const MINUTE = { hour: "2-digit", minute: "2-digit", hour12: false } as const;

/** A moment: its day, its minute, or both. */
export function dateText(
  time: number,
  part: "both" | "day" | "minute" = "both",
  of = language.get(),
): string {
  const options = { both: { ...DAY, ...MINUTE }, day: DAY, minute: MINUTE }[part];
  return format(of, options).format(time * 1000);
}

const isSameDay = (one: number, other: number): boolean =>
  new Date(one * 1000).toDateString() === new Date(other * 1000).toDateString();

/** Relative within a minute, clock time after, with the date on another day. */
export function whenText(time: number, now: number, of = language.get()): string {
  const age = now - time;
  if (age >= -1 && age < 1) return textIn(of, "just now");
  if (age >= 1 && age < 60) return textIn(of, "{age} ago", { age: `${Math.floor(age)} s` });
  return isSameDay(time, now) ? clockText(time, of) : dateText(time, "both", of);
}

/**
 * What stands above an entry of a list, newest first, where another day begins; else null.
 *
 * @param newer time of the entry before it, or now for the first.
 */
export function dayText(time: number, newer: number, of = language.get()): string | null {
  if (isSameDay(time, newer)) return null;
  return format(of, { weekday: "long", day: "numeric", month: "long" }).format(time * 1000);
}

/** Day, month, year and time to the second. */
export const wholeDateText = (time: number): string =>
  format(language.get(), { dateStyle: "medium", timeStyle: "medium", hour12: false }).format(
    time * 1000,
  );

/** A day of the week; 0 is a Monday. */
export function weekdayText(day: number, length: "short" | "long"): string {
  // The first of January 2024 was a Monday; noon, so that no zone of time makes it another day.
  return format(language.get(), { weekday: length }).format(new Date(2024, 0, 1 + day, 12));
}
