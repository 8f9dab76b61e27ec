/** A drill in words. */
import type { Drill, DrillDrive, ScheduledFault } from "../../api/drillTypes";
import { durationText } from "../../format";

/** `12 of 40 drives, about 2 min left`: nothing is promised before the first drive is over. */
export function progressText({ done, total, left }: Drill): string {
  if (done === 0) return "Reading the recipe; the first drives are under way.";
  const drives = `${done} of ${total} drives`;
  if (left === null || done === total) return drives;
  return `${drives}, about ${roughText(left)} left`;
}

/** An estimate is no stop-watch: `10 s` at the least, then in steps that grow with it. */
export function roughText(seconds: number): string {
  const step = seconds < 60 ? 10 : seconds < 300 ? 30 : 60;
  return durationText(Math.max(step, Math.round(seconds / step) * step));
}

/** The same shapes as where a back-test tells what is new and what no longer is. */
export const CHANGE_MARKS: Record<DrillDrive["change"], string> = {
  worse: "▲",
  better: "●",
  other: "○",
  same: "·",
};
export const CHANGE_WORDS: Record<DrillDrive["change"], string> = {
  worse: "worse",
  better: "better",
  other: "different",
  same: "the same",
};

/** `2 worse, 1 better`: only what there is. */
export function tallyText(drives: readonly DrillDrive[]): string {
  const kinds: DrillDrive["change"][] = ["worse", "better", "other", "same"];
  return kinds
    .map((kind) => ({ kind, count: drives.filter(({ change }) => change === kind).length }))
    .filter(({ count }) => count > 0)
    .map(({ kind, count }) => `${count} ${CHANGE_WORDS[kind]}`)
    .join(", ");
}

/** `way_blocked` and `kill:mapper` as they are said. */
export const faultText = (name: string) => name.replaceAll("_", " ").replace(":", " ");

/** What broke in a drive, when and for how long: by it drives are told apart. */
export function faultsText(faults: readonly ScheduledFault[]): string {
  if (faults.length === 0) return "no fault";
  return faults
    .map(({ name, at, duration }) => {
      const length = duration === 0 ? "" : ` for ${duration.toFixed(1)} s`;
      return `${faultText(name)} at ${at.toFixed(1)} s${length}`;
    })
    .join(", ");
}

/** How a drive differs, and what became of it, with its faults as they are said. */
export function toldText({ text, why, faults }: DrillDrive): string {
  return inWords(why === text ? text : `${text}. ${why}`, faults);
}

/** What is told of a drive, with its faults as they are said. */
export const inWords = (text: string, faults: readonly { name: string }[]): string =>
  faults.reduce((told, { name }) => told.replaceAll(name, faultText(name)), text);

/** `way blocked; 50 drives under each table, in hexagon`: what somebody asked for. */
export function wishText({ faults, drives, world, scenario }: Drill["wish"]): string {
  const broken = faults.map((name) => (name === "all" ? "any fault" : faultText(name)));
  const what = scenario ?? (broken.join(", ") || "no fault");
  return `${what}; ${drives === 1 ? "1 drive" : `${drives} drives`} under each table, in ${world}`;
}

/** Which robot, where, and that it may not be the one at hand. */
export function subjectText(
  recipe: string,
  robot: string,
  world: string,
  ownWorld: string | null,
): string {
  const place = `The embedded robot ${robot} drives ${recipe} in the world "${world}", in virtual time on this machine.`;
  return ownWorld === null
    ? `${place} It is not your robot, and those are not your rooms.`
    : `${place} The robot that you see is left alone.`;
}
