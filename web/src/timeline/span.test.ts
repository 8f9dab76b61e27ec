import { expect, test } from "vitest";
import { drawn, endsOf, moved, ticksOf, zoomed } from "./span";

const NOW = 1_700_000_000;

test("the last hours move with the clock, in steps, and hold now", () => {
  const ends = endsOf({ hours: 1 }, NOW, 60);
  expect(ends.until - ends.since).toBe(3600);
  expect(ends.until).toBeGreaterThanOrEqual(NOW);
  expect(ends.until - NOW).toBeLessThan(60);
  expect(endsOf({ hours: 1 }, NOW + 1, 60)).toEqual(ends);
});

test("nothing is looked at that has not happened yet", () => {
  const ends = { since: NOW - 3600, until: NOW };
  for (const span of [zoomed(ends, ends, 2, NOW), moved(ends, 0.5, NOW)]) {
    expect("until" in span && span.until).toBeLessThanOrEqual(NOW);
  }
  expect(zoomed(ends, ends, 2, NOW)).toEqual({ since: NOW - 7200, until: NOW });
  expect(moved(ends, -0.5, NOW)).toEqual({ since: NOW - 5400, until: NOW - 1800 });
});

test("what goes on with now does so when it is looked at more closely", () => {
  const span = { hours: 1 };
  expect(zoomed(span, endsOf(span, NOW, 60), 0.5, NOW)).toEqual({ hours: 0.5 });
});

test("a drag is looked at more closely, whichever way it went, and a tap is none", () => {
  const ends = { since: 1000, until: 2000 };
  expect(drawn(ends, 0.75, 0.25)).toEqual({ since: 1250, until: 1750 });
  expect(drawn(ends, -1, 0.5)).toEqual({ since: 1000, until: 1500 });
  expect(drawn(ends, 0.5, 0.505)).toBeNull();
});

test("marks are at whole minutes and hours, and not too many", () => {
  const hour = ticksOf({ since: NOW, until: NOW + 3600 }, 6);
  expect(hour.every((each) => each % 600 === 0)).toBe(true);
  expect(hour.length).toBeLessThanOrEqual(7);
  expect(ticksOf({ since: NOW, until: NOW + 7 * 86400 }, 8).length).toBeGreaterThan(3);
});
