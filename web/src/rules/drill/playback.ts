/** A drive at one moment of it: where the robot was, and what was going on. */
import type { Drive, Moment } from "../../api/drillTypes";
import { faultText, inWords } from "./drillText";

export interface Place {
  x: number;
  y: number;
  /** Radians, counter-clockwise from +x: where it went, or faced at first. */
  heading: number;
}

export interface Stretch {
  from: number;
  to: number;
  text: string;
}

export interface Mark {
  at: number;
  kind: MarkKind;
  text: string;
  x: number | null;
  y: number | null;
}

export type MarkKind = "fault" | "firing" | "stop" | "contact";

/** By kind; as in the report that can be downloaded. */
export const SHAPES: Record<MarkKind, string> = {
  fault: "▲",
  firing: "◆",
  stop: "■",
  contact: "✖",
};
const MARKED: ReadonlySet<string> = new Set(Object.keys(SHAPES));

const isMarked = (moment: Moment): moment is Moment & { kind: MarkKind } => MARKED.has(moment.kind);

/** Below this a step tells no direction [m]. */
const STEP = 0.01;

/** Index of the last of sorted times that is not after `at`; -1 when all are. */
function lastUpTo(times: readonly number[], at: number): number {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((times[middle] ?? Number.POSITIVE_INFINITY) <= at) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

/** The driven way, ready to be asked for any moment. */
export class Way {
  readonly times: number[] = [];
  readonly points: { x: number; y: number }[] = [];
  readonly #headings: number[] = [];

  constructor(drive: Drive) {
    let heading = drive.scenario.start?.yaw ?? 0;
    let told = false;
    for (const [at, x, y] of drive.track) {
      if (at === undefined || x === undefined || y === undefined) continue;
      const last = this.points.at(-1);
      if (last !== undefined && Math.hypot(x - last.x, y - last.y) >= STEP) {
        heading = Math.atan2(y - last.y, x - last.x);
        if (!told && drive.scenario.start === null) this.#headings.fill(heading);
        told = true;
      }
      this.times.push(at);
      this.points.push({ x, y });
      this.#headings.push(heading);
    }
  }

  /** Where it was; before the first and after the last point it stood there. Null without a way. */
  at(time: number): Place | null {
    const first = this.points[0];
    if (first === undefined) return null;
    const index = lastUpTo(this.times, time);
    const here = this.points[index];
    if (here === undefined) return { ...first, heading: this.#headings[0] ?? 0 };
    const next = this.points[index + 1];
    const began = this.times[index] ?? 0;
    const until = this.times[index + 1];
    const heading = this.#headings[index + 1] ?? this.#headings[index] ?? 0;
    if (next === undefined || until === undefined) return { ...here, heading };
    const share = until > began ? (time - began) / (until - began) : 0;
    return {
      x: here.x + share * (next.x - here.x),
      y: here.y + share * (next.y - here.y),
      heading,
    };
  }

  /** The points up to a moment, for a line as far as it was driven. */
  upTo(time: number): { x: number; y: number }[] {
    const here = this.at(time);
    const driven = this.points.slice(0, lastUpTo(this.times, time) + 1);
    return here === null ? driven : [...driven, { x: here.x, y: here.y }];
  }
}

export interface Lane {
  name: string;
  stretches: Stretch[];
  marks: Mark[];
}

/** Of marks of a kind that would lie over each other the first; the list in words has them all. */
function apart(marks: Mark[], near: (one: Mark, other: Mark) => boolean): Mark[] {
  const kept: Mark[] = [];
  for (const mark of marks) {
    if (!kept.some((other) => other.kind === mark.kind && near(mark, other))) kept.push(mark);
  }
  return kept;
}

/** What is marked on the map up to a moment; marks of a kind stand so far apart [m]. */
export function marksOnMap(drive: Drive, time: number, gap: number): Mark[] {
  const placed = marksOf(drive).filter(({ at, x, y }) => at <= time && x !== null && y !== null);
  return apart(
    placed,
    (one, other) => Math.hypot((one.x ?? 0) - (other.x ?? 0), (one.y ?? 0) - (other.y ?? 0)) < gap,
  );
}

/** What was when, as the lanes of a time line: the same for every drive. */
export function lanes(drive: Drive): Lane[] {
  const end = drive.duration;
  const marks = (kinds: MarkKind[]) =>
    apart(
      marksOf(drive).filter(({ kind }) => kinds.includes(kind)),
      (one, other) => Math.abs(one.at - other.at) < end / 100,
    );
  return [
    {
      name: "goal",
      stretches: drive.goals.map(({ sent, ended, outcome }, index) => ({
        from: sent,
        to: ended ?? end,
        text: `goal ${index + 1}: ${outcome === "" ? "not answered" : outcome}`,
      })),
      marks: [],
    },
    {
      name: "fault",
      stretches: drive.faults.map(({ began, ended, name }) => ({
        from: began,
        to: ended ?? end,
        text: faultText(name),
      })),
      marks: marks(["fault"]),
    },
    {
      name: "unwell",
      stretches: drive.unwell.map(({ begin, end: over, causes }) => ({
        from: begin,
        to: over,
        text: causes.join(", "),
      })),
      marks: [],
    },
    { name: "rules", stretches: [], marks: marks(["firing"]) },
    { name: "alert", stretches: stops(drive), marks: marks(["stop", "contact"]) },
  ];
}

/** When STOP was in force, until it was released or to the end. */
function stops(drive: Drive): Stretch[] {
  const found: Stretch[] = [];
  let pressed: Moment | null = null;
  for (const moment of drive.moments) {
    if (moment.kind === "stop") pressed ??= moment;
    if (moment.kind !== "release" || pressed === null) continue;
    found.push({ from: pressed.at, to: moment.at, text: pressed.text });
    pressed = null;
  }
  if (pressed !== null) found.push({ from: pressed.at, to: drive.duration, text: pressed.text });
  return found;
}

/** What has a mark of its own, on the map and on the time line. */
export function marksOf(drive: Drive): Mark[] {
  const found = new Map<string, Mark>();
  for (const moment of drive.moments) {
    // The same at the same moment is one mark.
    if (isMarked(moment))
      found.set(`${moment.at} ${moment.kind} ${moment.text}`, {
        ...moment,
        text: moment.kind === "fault" ? inWords(moment.text, faultsOf(drive)) : moment.text,
      });
  }
  return [...found.values()];
}

/** What became of it, in words. */
export const whyText = (drive: Drive): string => inWords(drive.why, faultsOf(drive));

/** That were to break it, and that did. */
const faultsOf = ({ scenario, faults }: Drive) => [...scenario.faults, ...faults];

/** What was going on, in a line: the goal, what was broken, and what was wrong with the robot. */
export function going(drive: Drive, time: number): string {
  if (time >= drive.duration) return whyText(drive);
  const during = (name: string) =>
    lanes(drive)
      .find((lane) => lane.name === name)
      ?.stretches.filter(({ from, to }) => from <= time && time < to) ?? [];
  const parts = [during("goal").length > 0 ? "under way" : "no goal"];
  const broken = during("fault").map(({ text }) => text);
  if (broken.length > 0) parts.push(`${[...new Set(broken)].join(", ")} on`);
  const causes = [...during("unwell"), ...during("alert")].map(({ text }) => text);
  if (causes.length > 0) parts.push([...new Set(causes)].join(", "));
  const fired = marksOf(drive).filter(
    ({ kind, at }) => kind === "firing" && at <= time && time - at < SHOWN,
  );
  if (fired.length > 0) parts.push(fired.map(({ text }) => text).join(", "));
  return parts.join(" · ");
}

/** Seconds for which what happened at one moment is told. */
const SHOWN = 2;

export const SPEEDS = [1, 2, 5, 10] as const;

/** The moment after `ms` of playing at a speed; it stays at the end. */
export const played = (time: number, ms: number, speed: number, end: number) =>
  Math.min(end, time + (ms / 1000) * speed);
