import { locale } from "./texts/language";
import { t } from "./texts/text";
import { lengthUnit, METRES_PER_FOOT, shown, speedUnit, units } from "./texts/units";

/** Numbers as an operator reads them, in the language and the units of the page. All inputs in SI units. */

const numbers = new Map<string, Intl.NumberFormat>();

/** `4.20`, or `4,20` where that is how numbers are written. */
export function fixed(value: number, decimals: number): string {
  const key = `${locale()} ${decimals}`;
  let format = numbers.get(key);
  if (format === undefined) {
    const digits = { minimumFractionDigits: decimals, maximumFractionDigits: decimals };
    format = new Intl.NumberFormat(locale(), { ...digits, useGrouping: false });
    numbers.set(key, format);
  }
  return format.format(value);
}

/** `12,480`, `12.480`: how many. */
export const countText = (count: number): string => count.toLocaleString(locale());

/** `0.2 s`, `12 s`, `3 min`, `2 h`: one decimal only where it tells something. */
export function ageText(seconds: number): string {
  const s = Math.max(0, seconds);
  if (s < 9.95) return `${fixed(s, 1)} s`;
  if (s < 60) return `${Math.floor(s)} s`;
  if (s < 3600) return `${Math.floor(s / 60)} min`;
  return `${Math.floor(s / 3600)} h`;
}

/** `3 s`, `2 min`: for sentences, never below one second. */
export function wholeAgeText(seconds: number): string {
  if (seconds < 60) return `${Math.max(1, Math.round(seconds))} s`;
  return ageText(seconds);
}

/** `4 cm` below a metre, `4.2 m` above, `120 m` when far; `5 in` below three feet, `14 ft` above. */
export function distanceText(metres: number): string {
  const m = Math.abs(metres);
  if (units.get() === "imperial") {
    if (m < 3 * METRES_PER_FOOT) return `${Math.round(12 * shown(m))} in`;
    return shown(m) < 9.95 ? `${fixed(shown(m), 1)} ft` : `${fixed(shown(m), 0)} ft`;
  }
  if (m < 0.995) return `${Math.round(m * 100)} cm`;
  return m < 99.5 ? `${fixed(m, 1)} m` : `${Math.round(m)} m`;
}

/** `0.25 m/s`, `1.2 ft/s`: as many decimals as say something, two at most. */
export const speedText = (metresPerSecond: number): string =>
  `${speedFigure(metresPerSecond)} ${speedUnit()}`;

/** The same without its unit. */
export function speedFigure(metresPerSecond: number): string {
  const figure = shown(metresPerSecond);
  return figure.toLocaleString(locale(), { maximumFractionDigits: 2, useGrouping: false });
}

/** `21 s`, `2 min 5 s`. */
export function durationText(seconds: number): string {
  const s = Math.max(0, Math.round(seconds));
  if (s < 60) return `${s} s`;
  const rest = s % 60;
  return rest === 0 ? `${Math.floor(s / 60)} min` : `${Math.floor(s / 60)} min ${rest} s`;
}

/** Radians as whole degrees in (-180, 180]. */
export function degreesText(radians: number): string {
  const turn = Math.round((radians * 180) / Math.PI) % 360;
  const degrees = turn > 180 ? turn - 360 : turn <= -180 ? turn + 360 : turn;
  return `${signed(degrees, 0)}°`;
}

/** A true minus sign, and no "-0.00". */
export function signed(value: number, decimals: number): string {
  const text = fixed(Math.abs(value), decimals);
  return value < 0 && Number(Math.abs(value).toFixed(decimals)) !== 0 ? `−${text}` : text;
}

/** `870 kB`, `4.2 MB`, `1.3 GB`: as the robot's disk is sold. */
export function bytesText(bytes: number): string {
  const names = ["kB", "MB", "GB"];
  let size = Math.max(0, bytes) / 1000;
  let unit = 0;
  while (size >= 999.5 && unit < names.length - 1) {
    size /= 1000;
    unit += 1;
  }
  return `${size < 9.95 && unit > 0 ? fixed(size, 1) : Math.round(size)} ${names[unit]}`;
}

/** `0.4 Hz`, `10 Hz`: how often something comes. */
export const hertzText = (rate: number): string =>
  `${rate < 9.95 ? fixed(rate, 1) : Math.round(rate)} Hz`;

/** `0.4 %`, `12 %`, of a share. */
export function percentText(share: number): string {
  const percent = 100 * share;
  return `${percent < 9.95 ? fixed(percent, 1) : Math.round(percent)} %`;
}

/** `a`, `a and b`, `a, b and c`. */
export function listText(parts: readonly string[]): string {
  const [first, ...rest] = parts;
  const last = rest.pop();
  if (first === undefined || last === undefined) return first ?? "";
  return t("{several} and {last}", { several: [first, ...rest].join(", "), last });
}

/** `x 1.50, y −0.25 m`, `x 4.92, y −0.82 ft`: a point of the map. */
export const pointText = (x: number, y: number): string =>
  `x ${signed(shown(x), 2)}, y ${signed(shown(y), 2)} ${lengthUnit()}`;
