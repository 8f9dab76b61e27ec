import type { Phrase } from "../texts/text";
/** The time that is looked at, in seconds since the epoch. */

/** The last hours up to now, and going on with it; or a time that stays. */
export type Span = { hours: number } | { since: number; until: number };

export const HOURS: readonly { hours: number; label: Phrase }[] = [
  { hours: 1, label: "1 h" },
  { hours: 8, label: "8 h" },
  { hours: 24, label: "24 h" },
  { hours: 168, label: "7 d" },
];

/** The least that is worth being looked at, s. */
const LEAST = 10;
const MOST = 400 * 24 * 3600;

export interface Ends {
  since: number;
  until: number;
}

/**
 * From when until when, with ends that move in steps of a slot: within one step the question stays
 * the same.
 */
export function endsOf(span: Span, now: number, slots: number): Ends {
  if ("since" in span) return span;
  const length = span.hours * 3600;
  const step = Math.max(1, length / slots);
  const until = Math.ceil(now / step) * step;
  return { since: until - length, until };
}

/**
 * Half as much of it, or twice as much: what goes on with now still does, all else about its middle
 * and never beyond now.
 */
export function zoomed(span: Span, ends: Ends, factor: number, now: number): Span {
  if ("hours" in span)
    return { hours: Math.min(MOST, Math.max(LEAST, span.hours * 3600 * factor)) / 3600 };
  const middle = (ends.since + ends.until) / 2;
  const length = Math.min(MOST, Math.max(LEAST, (ends.until - ends.since) * factor));
  return kept({ since: middle - length / 2, until: middle + length / 2 }, now);
}

/** A part of its length earlier (negative) or later. */
export function moved(ends: Ends, part: number, now: number): Span {
  const by = (ends.until - ends.since) * part;
  return kept({ since: ends.since + by, until: ends.until + by }, now);
}

/** What a hand has drawn over it, from and to as parts of its length; null for a mere tap. */
export function drawn(ends: Ends, from: number, to: number): Span | null {
  const [a, b] = from < to ? [from, to] : [to, from];
  if (b - a < 0.01) return null;
  const length = ends.until - ends.since;
  const since = ends.since + Math.max(0, a) * length;
  const until = ends.since + Math.min(1, b) * length;
  return until - since < LEAST ? around((since + until) / 2, LEAST) : { since, until };
}

const around = (middle: number, length: number): Span => ({
  since: middle - length / 2,
  until: middle + length / 2,
});

function kept({ since, until }: Ends, now: number): Span {
  const over = Math.max(0, until - now);
  return { since: Math.max(0, since - over), until: until - over };
}

const TICKS = [
  10, 30, 60, 300, 600, 1800, 3600, 7200, 14400, 28800, 86400, 172800, 604800, 2592000,
];

/** Moments at which the axis has a mark: whole minutes, hours or days of this browser's zone. */
export function ticksOf({ since, until }: Ends, most: number): number[] {
  const step = TICKS.find((each) => (until - since) / each <= most) ?? 7776000;
  // Whole days begin at midnight here, and not in Greenwich.
  const zone = new Date(since * 1000).getTimezoneOffset() * 60;
  const first = Math.ceil((since - zone) / step) * step + zone;
  const found: number[] = [];
  for (let at = first; at <= until; at += step) found.push(at);
  return found;
}
