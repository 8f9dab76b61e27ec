/** Durations as people write them. */

const UNITS: Record<string, number> = {
  ms: 0.001,
  s: 1,
  sec: 1,
  second: 1,
  seconds: 1,
  min: 60,
  m: 60,
  minute: 60,
  minutes: 60,
  h: 3600,
  hour: 3600,
  hours: 3600,
};
const PART = /^(\d+(?:[.,]\d+)?|[.,]\d+)\s*([a-z]*)\s*/i;

/** Seconds of `90`, `2.5 s`, `200 ms`, `1 min 30 s`, `1.5 h`; null of what is no duration. */
export function secondsOf(text: string): number | null {
  let rest = text.trim();
  let total = 0;
  let smallest = Number.POSITIVE_INFINITY;
  if (rest === "") return null;
  while (rest !== "") {
    const part = PART.exec(rest);
    if (part === null) return null;
    const [whole, number = "", word = ""] = part;
    const alone = total === 0 && whole.length === rest.length;
    // A bare number is of seconds, but not after minutes: nobody knows what "1 min 30" leaves out.
    const unit = word === "" && alone ? 1 : UNITS[word.toLowerCase()];
    if (unit === undefined || unit >= smallest) return null;
    smallest = unit;
    // Integers are multiplied before they are divided: 200 ms are 0.2 s, and not a hair beside it.
    const value = Number(number.replace(",", "."));
    total += unit < 1 ? value / Math.round(1 / unit) : value * unit;
    rest = rest.slice(whole.length);
  }
  return Number.isFinite(total) ? total : null;
}

/** As it stands in a field: `0.2 s`, `90 s`, `5 min`, `2 h`. Reads back as exactly the same. */
export function durationFieldText(seconds: number): string {
  if (seconds >= 7200 && seconds % 3600 === 0) return `${seconds / 3600} h`;
  if (seconds >= 120 && seconds % 60 === 0) return `${seconds / 60} min`;
  return `${seconds} s`;
}
