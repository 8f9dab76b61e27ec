/** Numbers as an operator reads them. All inputs in SI units. */

/** `0.2 s`, `12 s`, `3 min`, `2 h`: one decimal only where it tells something. */
export function ageText(seconds: number): string {
  const s = Math.max(0, seconds);
  if (s < 9.95) return `${s.toFixed(1)} s`;
  if (s < 60) return `${Math.floor(s)} s`;
  if (s < 3600) return `${Math.floor(s / 60)} min`;
  return `${Math.floor(s / 3600)} h`;
}

/** `3 s`, `2 min`: for sentences, never below one second. */
export function wholeAgeText(seconds: number): string {
  if (seconds < 60) return `${Math.max(1, Math.round(seconds))} s`;
  return ageText(seconds);
}

/** `4 cm` below a metre, `4.2 m` above, `120 m` when far. */
export function distanceText(metres: number): string {
  const m = Math.abs(metres);
  if (m < 0.995) return `${Math.round(m * 100)} cm`;
  return m < 99.5 ? `${m.toFixed(1)} m` : `${Math.round(m)} m`;
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
  const text = Math.abs(value).toFixed(decimals);
  return value < 0 && Number(text) !== 0 ? `−${text}` : text;
}

/** `870 kB`, `4.2 MB`, `1.3 GB`: as the robot's disk is sold. */
export function bytesText(bytes: number): string {
  const units = ["kB", "MB", "GB"];
  let size = Math.max(0, bytes) / 1000;
  let unit = 0;
  while (size >= 999.5 && unit < units.length - 1) {
    size /= 1000;
    unit += 1;
  }
  return `${size < 9.95 && unit > 0 ? size.toFixed(1) : Math.round(size)} ${units[unit]}`;
}

/** `0.4 Hz`, `10 Hz`: how often something comes. */
export const hertzText = (rate: number): string =>
  `${rate < 9.95 ? rate.toFixed(1) : Math.round(rate)} Hz`;

/** `0.4 %`, `12 %`, of a share. */
export function percentText(share: number): string {
  const percent = 100 * share;
  return `${percent < 9.95 ? percent.toFixed(1) : Math.round(percent)} %`;
}
