/** The time axis of a back-test: what is in view, and which marks would lie over each other. */
import type { BacktestFiring } from "../../api/ruleTypes";

/** A stretch of the recording in seconds since its start. */
export interface Window {
  from: number;
  to: number;
}

/** Marks nearer to each other than `gap` seconds, told as one. */
export interface Cluster {
  at: number;
  verdict: BacktestFiring["verdict"];
  firings: BacktestFiring[];
}

export function clusters(firings: readonly BacktestFiring[], view: Window, gap: number): Cluster[] {
  const found: Cluster[] = [];
  const newest = new Map<BacktestFiring["verdict"], Cluster>();
  for (const firing of [...firings].sort((a, b) => a.at - b.at)) {
    if (firing.at < view.from || firing.at > view.to) continue;
    const last = newest.get(firing.verdict);
    if (last !== undefined && firing.at - last.at < gap) {
      last.firings.push(firing);
    } else {
      const cluster: Cluster = { at: firing.at, verdict: firing.verdict, firings: [firing] };
      newest.set(firing.verdict, cluster);
      found.push(cluster);
    }
  }
  return found;
}

/** @param factor below 1 looks closer. `at` stays where it is, as far as the recording reaches. */
export function zoom(view: Window, whole: Window, factor: number, at: number): Window {
  const length = Math.min(whole.to - whole.from, Math.max(1, (view.to - view.from) * factor));
  const share = (at - view.from) / (view.to - view.from || 1);
  return clamp({ from: at - share * length, to: at + (1 - share) * length }, whole);
}

/** @param by shares of what is in view; negative looks earlier. */
export function pan(view: Window, whole: Window, by: number): Window {
  const step = (view.to - view.from) * by;
  return clamp({ from: view.from + step, to: view.to + step }, whole);
}

function clamp({ from, to }: Window, whole: Window): Window {
  const length = Math.min(to - from, whole.to - whole.from);
  const start = Math.min(Math.max(from, whole.from), whole.to - length);
  return { from: start, to: start + length };
}

const STEPS = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 1800, 3600];

/** Round times in view for the axis, at most `most` of them. */
export function ticks(view: Window, most: number): number[] {
  const length = view.to - view.from;
  const step = STEPS.find((each) => length / each <= most) ?? 7200;
  const first = Math.ceil(view.from / step) * step;
  const count = Math.max(0, Math.floor((view.to - first) / step) + 1);
  return Array.from({ length: count }, (_, index) => first + index * step);
}

/** `0:05`, `12:30`: a time since the start of the recording. */
export function atText(seconds: number): string {
  const whole = Math.max(0, Math.round(seconds));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}
