import type { Session, State } from "../api/types";
import { chargeText } from "../battery/batteryText";
import { controlView } from "../control/controlText";
import { goalLine } from "../goal/goalText";
import { runLine } from "../missions/missionText";
import { rootCause } from "../state/causes";
import { language } from "../texts/language";
import { t } from "../texts/text";
import { told } from "../texts/told";

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
  const by = told(drive.stopped_by);
  const word = by === "" ? t("Stopped") : t("Stopped by {by}", { by });
  const title = drive.reason === "" ? word : `${word}: ${told(drive.reason)}`;
  const body = t("It stays where it is until a person releases STOP.");
  return [{ tag: "stop", title, body, urgent: true }];
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
    const body = run.phase === "paused" ? `${more} ${t("Resume it, or cancel it.")}`.trim() : more;
    found.push({
      tag: "mission",
      title: `${run.name}: ${language.get() === "en" ? text.charAt(0).toLowerCase() + text.slice(1) : text}`,
      body,
      urgent: run.phase !== "done",
    });
  }
  const { notice } = now.missions;
  if (notice !== "" && notice !== before.missions.notice)
    found.push({
      tag: "missions",
      title: t("A mission did not begin"),
      body: told(notice),
      urgent: true,
    });
  return found;
}

function rules(before: State, now: State): Notice[] {
  const { rules: was } = before;
  const { rules: is } = now;
  const found: Notice[] = [];
  if (is.available && was.available && is.alarms > was.alarms)
    found.push({
      tag: "alarm",
      title: t("{alarms, plural, one {A rule has raised an alarm} other {# alarms are raised}}", {
        alarms: is.alarms,
      }),
      body: t("Look at what it says, above the scene."),
      urgent: true,
    });
  if (was.probation_left > 0 && is.probation_left <= 0 && is.available)
    found.push(
      is.revision === was.revision
        ? {
            tag: "probation",
            title: t("Probation of revision {revision} has ended", { revision: is.revision }),
            body: is.notice,
            urgent: false,
          }
        : {
            tag: "probation",
            title: t("Rules went back: revision {revision} is in force", { revision: is.revision }),
            body: is.notice,
            urgent: true,
          },
    );
  return found;
}

function battery({ battery: was }: State, { battery: is }: State): Notice[] {
  if (is === null || !is.low || is.charging || was?.low !== false) return [];
  const body = t("Send it home, or charge it.");
  return [
    {
      tag: "battery",
      title: t("Battery low: {charge}", { charge: chargeText(is) }),
      body,
      urgent: true,
    },
  ];
}

function control(before: State, now: State, session: Session): Notice[] {
  const was = controlView(before.control, session, 0);
  const is = controlView(now.control, session, 0);
  const found: Notice[] = [];
  if (is.askedBy !== "" && is.askedBy !== was.askedBy)
    found.push({
      tag: "control",
      title: t("{askedBy} asks you for control", { askedBy: is.askedBy }),
      body: t("Give it or keep it; after 20 s it may be taken."),
      urgent: true,
    });
  if (is.lost !== null && was.lost === null)
    found.push({
      tag: "control",
      title: t("{by} has taken control from you", { by: is.lost.by }),
      body: is.lost.reason,
      urgent: true,
    });
  return found;
}
