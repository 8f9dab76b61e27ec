import { ApiError } from "./errors";
import { answer, http, QUICK_MS, within } from "./http";
import type {
  GoalPick,
  GoalPoint,
  LocatePick,
  LocatePoint,
  PlaceGoal,
  PlayedDrive,
  RobotPose,
  Session,
  ViewPatch,
} from "./types";

/** A goal is checked and sent by way of the robot's planner. */
const GOAL_MS = 8000;
/** Passwords are proved one after the other, and slowly on purpose. */
const LOGIN_MS = 8000;
/** The drive manager has 1 s to answer the console; a little more for the network. */
const STOP_MS = 2000;
/** Of those who are not logged in one may have to wait until another was answered. */
const OPEN_STOP_MS = 3500;

export const login = (proof: { token: string } | { user: string; password: string }) =>
  answer(http.POST("/api/login", { body: proof, signal: within(LOGIN_MS) }));

/** How one may log in to this console. */
export const waysIn = () => answer(http.GET("/api/login", { signal: within(QUICK_MS) }));

/** The session of this browser's cookie, or null when it has none. */
export async function currentSession(): Promise<Session | null> {
  try {
    return await answer(http.GET("/api/session", { signal: within(QUICK_MS) }));
  } catch (error) {
    if (error instanceof ApiError && error.status === 401) return null;
    throw error;
  }
}

export const logout = () => answer(http.POST("/api/logout", { signal: within(QUICK_MS) }));

/** Ends all other sessions of this account; this one goes on. */
export const logoutOthers = () =>
  answer(http.POST("/api/logout/others", { signal: within(QUICK_MS) }));

export const createView = () => answer(http.POST("/api/views", { signal: within(QUICK_MS) }));

export const patchView = (id: string, patch: ViewPatch) =>
  answer(
    http.PATCH("/api/views/{view_id}", {
      params: { path: { view_id: id } },
      body: patch,
      signal: within(QUICK_MS),
    }),
  );

/** Shows a drive of a drill in the view, in the place of the robot. */
export const playDrive = (id: string, played: PlayedDrive) =>
  answer(
    http.PUT("/api/views/{view_id}/drive", {
      params: { path: { view_id: id } },
      body: played,
      signal: within(QUICK_MS),
    }),
  );

/** Shows the robot in the view again. */
export const leaveDrive = (id: string) =>
  answer(
    http.DELETE("/api/views/{view_id}/drive", {
      params: { path: { view_id: id } },
      signal: within(QUICK_MS),
    }),
  );

export const removePreview = (id: string) =>
  answer(
    http.DELETE("/api/views/{view_id}/preview", {
      params: { path: { view_id: id } },
      signal: within(QUICK_MS),
    }),
  );

export const checkGoal = (goal: GoalPick | GoalPoint | PlaceGoal, signal: AbortSignal) =>
  answer(http.POST("/api/goals/check", { body: goal, signal: within(GOAL_MS, signal) }));

export const sendGoal = (goal: GoalPoint | PlaceGoal) =>
  answer(http.POST("/api/goals", { body: goal, signal: within(GOAL_MS) }));

export const checkRobotPose = (place: LocatePick | LocatePoint, signal: AbortSignal) =>
  answer(http.POST("/api/localisation/check", { body: place, signal: within(GOAL_MS, signal) }));

export const setRobotPose = (place: RobotPose) =>
  answer(http.POST("/api/localisation", { body: place, signal: within(QUICK_MS) }));

export const cancelGoal = () =>
  answer(http.POST("/api/goals/cancel", { signal: within(QUICK_MS) }));

/** A session that ended without a word, while the page was open, keeps nobody from STOP. */
export async function stopRobot() {
  try {
    return await answer(
      http.POST("/api/stop", { body: { reason: "" }, signal: within(STOP_MS), priority: "high" }),
    );
  } catch (error) {
    if (error instanceof ApiError && error.status === 401) return stopWithoutLogin();
    throw error;
  }
}

export const stopWithoutLogin = () =>
  answer(http.POST("/api/stop/without-login", { signal: within(OPEN_STOP_MS), priority: "high" }));

/** Whether STOP takes no log-in here, and what became of it. */
export const openStop = (signal: AbortSignal) =>
  answer(http.GET("/api/stop/without-login", { signal: within(STOP_MS, signal) }));

/** A release is on the robot's disk before it is answered, which the console awaits for a few seconds. */
export const releaseStop = () =>
  answer(http.POST("/api/stop/release", { signal: within(QUICK_MS) }));
