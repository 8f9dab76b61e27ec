import type { Session, State } from "../api/types";
import { chargeText } from "../battery/batteryText";
import { controlView } from "../control/controlText";
import { goalLine } from "../goal/goalText";
import { runLine } from "../missions/missionText";
import { rootCause } from "../state/causes";

/** Something that whoever is responsible for the robot should hear of. */
export interface Notice {
  /** Notices of one tag are about one thing: a newer one takes the place of the older. */
  tag: string;
  title: string;
  /** What to do. */
  body: string;
  /** Somebody has to do something. */
  urgent: boolean;
}

/**
 * What has happened between two states of the robot. What was so when the page was opened is no
 * news, and neither is what this person has just done.
 */
export function noticesBetween(before: State, now: State, session: Session): Notice[] {
  return [
    ...stopped(before, now, session),
    ...faults(before, now),
    ...goals(before, now),
    ...missions(before, now, session),
    ...rules(before, now),
    ...control(before, now, session),
    ...battery(before, now),
  ];
}

function stopped(before: State, now: State, session: Session): Notice[] {
  const { drive } = now;
  if (before.drive === null || before.drive.stopped || !drive?.stopped) return [];
  if (drive.stopped_by === session.user) return [];
  const by = drive.stopped_by === "" ? "" : ` by ${drive.stopped_by}`;
  const why = drive.reason === "" ? "" : `: ${drive.reason}`;
  const body = "It stays where it is until a person releases STOP.";
  return [{ tag: "stop", title: `Stopped${by}${why}`, body, urgent: true }];
}

function faults(before: State, now: State): Notice[] {
  const was = rootCause(before, 0);
  const is = rootCause(now, 0);
  if (is === null || is.minor || is.name === was?.name) return [];
  return [{ tag: "fault", title: is.name, body: is.advice, urgent: is.level === "failed" }];
}

function goals(before: State, now: State): Notice[] {
  const {
    goal,
    missions: { run },
  } = now;
  if (goal === null || goal.phase !== "failed") return [];
  if (before.goal?.id === goal.id && before.goal.phase === "failed") return [];
  if (run !== null && run.phase !== "canceled" && run.phase !== "done") return []; // told with it
  const { text, more } = goalLine(goal, now.drive, rootCause(now, 0));
  return [{ tag: "goal", title: text, body: more, urgent: true }];
}

const TOLD = new Set(["asking", "paused", "failed", "done"]);

function missions(before: State, now: State, session: Session): Notice[] {
  const { run } = now.missions;
  const was = before.missions.run;
  const found: Notice[] = [];
  const same = was !== null && was.number === run?.number && was.step === run.step;
  if (run !== null && !same && TOLD.has(run.phase) && run.decided_by !== session.user) {
    const { text, more } = runLine(run, 0);
    const body = run.phase === "paused" ? `${more} Resume it, or cancel it.`.trim() : more;
    found.push({
      tag: "mission",
      title: `${run.name}: ${text.charAt(0).toLowerCase()}${text.slice(1)}`,
      body,
      urgent: run.phase !== "done",
    });
  }
  const { notice } = now.missions;
  if (notice !== "" && notice !== before.missions.notice)
    found.push({ tag: "missions", title: "A mission did not begin", body: notice, urgent: true });
  return found;
}

function rules(before: State, now: State): Notice[] {
  const { rules: was } = before;
  const { rules: is } = now;
  const found: Notice[] = [];
  if (is.available && was.available && is.alarms > was.alarms)
    found.push({
      tag: "alarm",
      title: is.alarms === 1 ? "A rule has raised an alarm" : `${is.alarms} alarms are raised`,
      body: "Look at what it says, above the scene.",
      urgent: true,
    });
  if (was.probation_left > 0 && is.probation_left <= 0 && is.available)
    found.push(
      is.revision === was.revision
        ? {
            tag: "probation",
            title: `Probation of revision ${is.revision} has ended`,
            body: is.notice,
            urgent: false,
          }
        : {
            tag: "probation",
            title: `Rules went back: revision ${is.revision} is in force`,
            body: is.notice,
            urgent: true,
          },
    );
  return found;
}

function battery({ battery: was }: State, { battery: is }: State): Notice[] {
  if (is === null || !is.low || is.charging || was?.low !== false) return [];
  const body = "Send it home, or charge it.";
  return [{ tag: "battery", title: `Battery low: ${chargeText(is)}`, body, urgent: true }];
}

function control(before: State, now: State, session: Session): Notice[] {
  const was = controlView(before.control, session, 0);
  const is = controlView(now.control, session, 0);
  const found: Notice[] = [];
  if (is.askedBy !== "" && is.askedBy !== was.askedBy)
    found.push({
      tag: "control",
      title: `${is.askedBy} asks you for control`,
      body: "Give it or keep it; after 20 s it may be taken.",
      urgent: true,
    });
  if (is.lost !== null && was.lost === null)
    found.push({
      tag: "control",
      title: `${is.lost.by} has taken control from you`,
      body: is.lost.reason,
      urgent: true,
    });
  return found;
}
