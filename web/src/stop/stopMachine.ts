import type { Drive } from "../api/types";
import { type Phrase, t } from "../texts/text";

/** What is to be known of the robot, to say what became of STOP. */
export type Latch = Pick<Drive, "stopped" | "standstill">;

/**
 * What STOP shows. Honest by construction: "stopped" only while the drive manager says that it is
 * latched *and* odometry says standstill, never because a request was answered. "silent" is a robot
 * that was stopped when it was last heard of: it comes back as it was.
 */
export type StopPhase = "idle" | "stopping" | "stopped" | "unconfirmed" | "silent";

export interface StopState {
  phase: StopPhase;
  /** When this stop began (ms on the page's clock). */
  since: number;
  /** The drive manager has reported the latch since then. */
  latched: boolean;
  /** Why it is unconfirmed, and what to do. */
  problem: string;
  remedy: string;
}

export type StopEvent =
  | { type: "pressed"; now: number }
  | { type: "refused"; problem: string; remedy: string }
  /** `drive` is null when the newest report is too old to believe. */
  | { type: "observed"; drive: Latch | null; now: number }
  | { type: "dismissed" };

export const IDLE: StopState = {
  phase: "idle",
  since: 0,
  latched: false,
  problem: "",
  remedy: "",
};

/** A robot that was told to stop stands still within this time, or a person must look. */
export const CONFIRM_WITHIN_MS = 2000;

const LOOK: Phrase = "Press STOP again; if it keeps moving, use the emergency button on the robot.";

export function stopReducer(state: StopState, event: StopEvent): StopState {
  switch (event.type) {
    case "pressed":
      return { ...IDLE, phase: "stopping", since: event.now };
    case "refused":
      // Another operator's stop, or ours over another way, may have worked all the same.
      if (state.phase !== "stopping" && state.phase !== "unconfirmed") return state;
      return {
        ...state,
        phase: "unconfirmed",
        problem: event.problem,
        remedy: event.remedy || t(LOOK),
      };
    case "dismissed":
      return state.phase === "unconfirmed" && !state.latched ? IDLE : state;
    case "observed":
      return observe(state, event.drive, event.now);
  }
}

function observe(state: StopState, drive: Latch | null, now: number): StopState {
  if (drive?.stopped && drive.standstill) {
    return state.phase === "stopped" ? state : { ...IDLE, phase: "stopped", latched: true };
  }
  if (drive !== null && !drive.stopped && state.latched) return IDLE; // released
  switch (state.phase) {
    case "idle":
      // Somebody else pressed it: count from when we heard.
      return drive?.stopped ? { ...IDLE, phase: "stopping", since: now, latched: true } : state;
    case "stopped":
      if (drive === null) return { ...IDLE, phase: "silent", latched: true };
      return { ...IDLE, phase: "unconfirmed", latched: true, problem: t(MOVING), remedy: t(LOOK) };
    case "stopping": {
      const latched = state.latched || drive?.stopped === true;
      if (now - state.since < CONFIRM_WITHIN_MS) {
        return latched === state.latched ? state : { ...state, latched };
      }
      return { ...state, phase: "unconfirmed", latched, problem: why(drive), remedy: t(LOOK) };
    }
    case "silent":
      // It is back, stopped still, and its standstill is yet to be measured.
      return drive === null ? state : { ...state, phase: "stopping", since: now };
    case "unconfirmed":
      return drive?.stopped && !state.latched ? { ...state, latched: true } : state;
  }
}

const MOVING: Phrase =
  "Standstill is no longer confirmed: the odometry reports motion, or is silent.";

function why(drive: Latch | null): string {
  if (drive === null)
    return t("The drive manager is silent: nobody confirms that the robot stopped.");
  if (!drive.stopped) return t("The drive manager has not taken the stop.");
  return t("The wheels are blocked but no standstill was measured within 2 s.");
}

/** The two lines on the button. */
export function stopLabel(phase: StopPhase): { word: string; spoken: string } {
  switch (phase) {
    case "idle":
      return { word: t("STOP"), spoken: t("Stop the robot") };
    case "stopping":
      return {
        word: t("Stopping…"),
        spoken: t("Stopping, not confirmed yet. Press to stop again"),
      };
    case "stopped":
      return {
        word: t("Stopped"),
        spoken: t("Robot stopped, standstill confirmed. Press to stop again"),
      };
    case "silent":
      return {
        word: t("STOP"),
        spoken: t("Stop the robot. It was stopped when it was last heard of"),
      };
    case "unconfirmed":
      return { word: t("Not confirmed"), spoken: t("Stop not confirmed. Press to stop again") };
  }
}
