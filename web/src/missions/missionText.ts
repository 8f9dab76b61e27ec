import type { Mission, MissionRun, MissionSave, Place } from "../api/types";
import { durationText } from "../format";

/** How a line is meant: calm, good news, or something for a person. */
type Tone = "plain" | "done" | "problem";

export interface RunLine {
  tone: Tone;
  text: string;
  /** Why, or what to do. */
  more: string;
}

const OVER = new Set(["done", "failed", "canceled"]);

/** Whether the goal that is followed is that of the mission, and told of with it. */
export function tellsGoal(run: MissionRun | null, goalUnderWay: boolean): boolean {
  return run !== null && !isOver(run) && (run.phase === "driving" || !goalUnderWay);
}

export const isOver = (run: MissionRun) => OVER.has(run.phase);

/** What a mission is doing; `elapsed` is how long ago (s) the page was told. */
export function runLine(run: MissionRun, elapsed: number): RunLine {
  const place = run.place === "" ? "a place that is gone" : run.place;
  switch (run.phase) {
    case "driving":
      return {
        tone: "plain",
        text: `Driving to ${place}`,
        more: run.attempt > 1 ? `${run.reason} Attempt ${run.attempt}.`.trim() : "",
      };
    case "waiting": {
      const left = run.left === null ? null : Math.max(0, run.left - elapsed);
      const time = left === null ? "" : `, ${durationText(left)} left`;
      return { tone: "plain", text: `Waiting at ${place}${time}`, more: "" };
    }
    case "asking":
      return {
        tone: "problem",
        text: `Waits for a person at ${place}`,
        more: run.ask === "" ? "Press Go on when it may." : run.ask,
      };
    case "acting":
      return { tone: "plain", text: `At ${place}: ${run.task}`, more: "" };
    case "paused":
      return {
        tone: "problem",
        text: run.decided_by === "" ? "Paused" : `Paused by ${run.decided_by}`,
        more: asSentence(run.reason),
      };
    case "done":
      return { tone: "done", text: "Mission done", more: skippedText(run) };
    case "failed":
      return { tone: "problem", text: "Mission failed", more: asSentence(run.reason) };
    case "canceled":
      return {
        tone: "plain",
        text: run.decided_by === "" ? "Mission cancelled" : `Cancelled by ${run.decided_by}`,
        more: "",
      };
  }
}

function skippedText({ skipped }: MissionRun): string {
  if (skipped.length === 0) return "";
  return `Left out: ${skipped.join("; ")}`;
}

function asSentence(text: string): string {
  if (text === "") return "";
  const first = text[0]?.toLocaleUpperCase() + text.slice(1);
  return /[.!?]$/.test(first) ? first : `${first}.`;
}

/** `Place 2 of 5 · round 3 of 10`. */
export function progressText(run: MissionRun): string {
  const place = `Place ${run.waypoint} of ${run.waypoints}`;
  if (run.rounds === 1) return place;
  return `${place} · round ${run.round}${run.rounds === 0 ? "" : ` of ${run.rounds}`}`;
}

const DAYS = ["Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun"];
export const DAY_NAMES = [
  "Monday",
  "Tuesday",
  "Wednesday",
  "Thursday",
  "Friday",
  "Saturday",
  "Sunday",
];

/** `3 places, 10 rounds, daily at 08:00`. */
export function missionText({ waypoints, rounds, schedule }: Mission): string {
  const parts = [waypoints.length === 1 ? "1 place" : `${waypoints.length} places`];
  if (rounds === 0) parts.push("round and round");
  else if (rounds > 1) parts.push(`${rounds} rounds`);
  if (schedule !== null) parts.push(scheduleText(schedule));
  return parts.join(", ");
}

function scheduleText({ at, days }: NonNullable<Mission["schedule"]>): string {
  const text = days.join();
  if (text === "0,1,2,3,4,5,6") return `daily at ${at}`;
  if (text === "0,1,2,3,4") return `Mon to Fri at ${at}`;
  return `${days.map((day) => DAYS[day]).join(", ")} at ${at}`;
}

export const nameOf = (places: readonly Place[], id: number) =>
  places.find((place) => place.id === id)?.name ?? null;

/** What is wrong with a mission, in a sentence; null when nothing is that this page can tell. */
export function missionProblem(mission: MissionSave, places: readonly Place[]): string | null {
  if (mission.name.trim() === "") return "Give the mission a name.";
  if (mission.waypoints.length === 0) return "Add a place to go to.";
  const gone = mission.waypoints.findIndex(
    ({ place }) => !places.some((each) => each.id === place && each.here),
  );
  if (gone >= 0) return `Place ${gone + 1} is there no more, or on another map; choose another.`;
  if (mission.schedule && mission.schedule.days?.length === 0)
    return "Choose a day on which it begins.";
  return null;
}
