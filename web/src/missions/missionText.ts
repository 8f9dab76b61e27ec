import type { Action } from "../api/ruleTypes";
import type { Mission, MissionRun, MissionSave, MissionTask, Place } from "../api/types";
import { durationText } from "../format";
import { actionGap } from "../rules/changes/findings";
import { weekdayText } from "../texts/dates";
import { t } from "../texts/text";
import { told } from "../texts/told";

/** How a line is meant: calm, good news, or something for a person. */
type Tone = "plain" | "done" | "problem";

export interface RunLine {
  tone: Tone;
  text: string;
  /** Why, or what to do. */
  more: string;
}

const OVER = new Set(["done", "failed", "canceled"]);

/** As the console names a mission that has sent a goal. */
const SENT_BY_MISSION = "mission ";

/** Whether a goal, under way or ended, is that of the mission, and told of with it. */
export function tellsGoal(run: MissionRun | null, sentBy: string): boolean {
  return (
    run !== null && !isOver(run) && (run.phase === "driving" || sentBy.startsWith(SENT_BY_MISSION))
  );
}

export const isOver = (run: MissionRun) => OVER.has(run.phase);

/** What a mission is doing; `elapsed` is how long ago (s) the page was told. */
export function runLine(run: MissionRun, elapsed: number): RunLine {
  const place = run.place === "" ? t("a place that is gone") : run.place;
  switch (run.phase) {
    case "driving":
      return {
        tone: "plain",
        text: t("Driving to {place}", { place }),
        more:
          run.attempt > 1
            ? `${told(run.reason)} ${t("Attempt {attempt}.", { attempt: run.attempt })}`.trim()
            : "",
      };
    case "waiting": {
      const left = run.left === null ? null : Math.max(0, run.left - elapsed);
      const text =
        left === null
          ? t("Waiting at {place}", { place })
          : t("Waiting at {place}, {duration} left", { place, duration: durationText(left) });
      return { tone: "plain", text, more: "" };
    }
    case "asking":
      return {
        tone: "problem",
        text: t("Waits for a person at {place}", { place }),
        more: run.ask === "" ? t("Press Go on when it may.") : run.ask,
      };
    case "acting":
      return { tone: "plain", text: t("At {place}: {task}", { place, task: run.task }), more: "" };
    case "paused":
      return {
        tone: "problem",
        text:
          run.decided_by === ""
            ? t("Paused, next is {place}", { place })
            : t("Paused by {by}, next is {place}", { by: run.decided_by, place }),
        more: asSentence(told(run.reason)),
      };
    case "done":
      return { tone: "done", text: t("Mission done"), more: skippedText(run) };
    case "failed":
      return { tone: "problem", text: t("Mission failed"), more: asSentence(told(run.reason)) };
    case "canceled":
      return {
        tone: "plain",
        text:
          run.decided_by === ""
            ? t("Mission cancelled")
            : t("Cancelled by {by}", { by: run.decided_by }),
        more: "",
      };
  }
}

function skippedText({ skipped }: MissionRun): string {
  if (skipped.length === 0) return "";
  return t("Left out: {names}", { names: skipped.join("; ") });
}

function asSentence(text: string): string {
  if (text === "") return "";
  const first = text[0]?.toLocaleUpperCase() + text.slice(1);
  return /[.!?]$/.test(first) ? first : `${first}.`;
}

/** `Place 2 of 5 · round 3 of 10`. */
export function progressText(run: MissionRun): string {
  const place = t("Place {waypoint} of {waypoints}", {
    waypoint: run.waypoint,
    waypoints: run.waypoints,
  });
  if (run.rounds === 1) return place;
  const { round, rounds } = run;
  const text =
    rounds === 0
      ? t("round {round}", { round })
      : t("round {round} of {rounds}", { round, rounds });
  return `${place} · ${text}`;
}

/** Days of the week as the robot counts them: 0 is a Monday. */
export const WEEK = [0, 1, 2, 3, 4, 5, 6] as const;

/** `3 places, 10 rounds, daily at 08:00`. */
export function missionText({ waypoints, rounds, schedule }: Mission): string {
  const parts = [t("{n, plural, one {# place} other {# places}}", { n: waypoints.length })];
  if (rounds === 0) parts.push(t("round and round"));
  else if (rounds > 1)
    parts.push(t("{rounds, plural, one {# round} other {# rounds}}", { rounds }));
  if (schedule !== null) parts.push(scheduleText(schedule));
  return parts.join(", ");
}

function scheduleText({ at, days }: NonNullable<Mission["schedule"]>): string {
  const text = days.join();
  if (text === "0,1,2,3,4,5,6") return t("daily at {at}", { at });
  if (text === "0,1,2,3,4") return t("Mon to Fri at {at}", { at });
  return t("{days} at {at}", { days: days.map((day) => weekdayText(day, "short")).join(", "), at });
}

export const nameOf = (places: readonly Place[], id: number) =>
  places.find((place) => place.id === id)?.name ?? null;

/** What a task at a place still lacks, and the remedy; null where nothing is missing. */
export function taskGap(task: MissionTask): string | null {
  const gap = task.kind === "act" ? actionGap(task.action as Action) : null;
  return gap === null ? null : gap.map(told).join(" ");
}

/** What is wrong with a mission, in a sentence; null when nothing is that this page can tell. */
export function missionProblem(mission: MissionSave, places: readonly Place[]): string | null {
  if (mission.name.trim() === "") return t("Give the mission a name.");
  if (mission.waypoints.length === 0) return t("Add a place to go to.");
  const gone = mission.waypoints.findIndex(
    ({ place }) => !places.some((each) => each.id === place && each.here),
  );
  if (gone >= 0)
    return t("Place {gone} is there no more, or on another map; choose another.", {
      gone: gone + 1,
    });
  for (const [index, waypoint] of mission.waypoints.entries()) {
    for (const [at, task] of (waypoint.tasks ?? []).entries()) {
      const gap = taskGap(task);
      if (gap !== null)
        return t("Place {place}, task {task}: {gap}", { place: index + 1, task: at + 1, gap });
    }
  }
  if (mission.schedule && mission.schedule.days?.length === 0)
    return t("Choose a day on which it begins.");
  return null;
}
