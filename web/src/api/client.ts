import { ApiError, errorFromBody, noAnswer } from "./errors";
import type {
  GoalCheck,
  GoalPick,
  GoalPoint,
  GoalSent,
  Session,
  StopAnswer,
  View,
  ViewPatch,
} from "./types";

type Method = "GET" | "POST" | "PATCH" | "DELETE";

interface Options {
  body?: unknown;
  signal?: AbortSignal;
  timeoutMs?: number;
  priority?: RequestPriority;
}

/**
 * One request to the console.
 *
 * @throws ApiError with the server's own words, or with status 0 when no answer came in time.
 * @throws DOMException "AbortError" when the caller's `signal` was aborted.
 */
export async function request<T>(method: Method, path: string, options: Options = {}): Promise<T> {
  const timeout = AbortSignal.timeout(options.timeoutMs ?? 5000);
  const init: RequestInit = {
    method,
    credentials: "same-origin",
    cache: "no-store",
    priority: options.priority ?? "auto",
    signal: options.signal ? AbortSignal.any([options.signal, timeout]) : timeout,
  };
  if (options.body !== undefined) {
    init.body = JSON.stringify(options.body);
    init.headers = { "Content-Type": "application/json" };
  }
  let response: Response;
  let text: string;
  try {
    response = await fetch(path, init);
    text = await response.text();
  } catch (error) {
    if (options.signal?.aborted) throw error;
    throw noAnswer();
  }
  const body = parse(text);
  if (!response.ok) throw errorFromBody(response.status, body);
  return body as T;
}

function parse(text: string): unknown {
  if (text === "") return undefined;
  try {
    return JSON.parse(text);
  } catch {
    // A proxy's HTML error page; the status says enough.
    return undefined;
  }
}

export const login = (token: string) =>
  request<Session>("POST", "/api/login", { body: { token, user: null } });

/** The session of this browser's cookie, or null when it has none. */
export async function currentSession(): Promise<Session | null> {
  try {
    return await request<Session>("GET", "/api/session");
  } catch (error) {
    if (error instanceof ApiError && error.status === 401) return null;
    throw error;
  }
}

export const logout = () => request<void>("POST", "/api/logout");

export const createView = () => request<View>("POST", "/api/views");

export const patchView = (id: string, patch: ViewPatch) =>
  request<View>("PATCH", `/api/views/${encodeURIComponent(id)}`, { body: patch });

export const removePreview = (id: string) =>
  request<void>("DELETE", `/api/views/${encodeURIComponent(id)}/preview`);

export const checkGoal = (goal: GoalPick | GoalPoint, signal: AbortSignal) =>
  request<GoalCheck>("POST", "/api/goals/check", { body: goal, signal, timeoutMs: 8000 });

export const sendGoal = (goal: GoalPoint) =>
  request<GoalSent>("POST", "/api/goals", { body: goal, timeoutMs: 8000 });

export const cancelGoal = () => request<void>("POST", "/api/goals/cancel");

/** The drive manager has 1 s to answer the console; a little more for the network. */
export const stopRobot = () =>
  request<StopAnswer>("POST", "/api/stop", { body: {}, timeoutMs: 2000, priority: "high" });

export const releaseStop = () =>
  request<StopAnswer>("POST", "/api/stop/release", { timeoutMs: 2000 });
