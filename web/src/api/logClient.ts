import { answer, http, QUICK_MS, within } from "./http";
import type { LogLevel } from "./types";

/** Which lines of the robot's log are wanted; what is empty is not asked for. */
export interface LogQuery {
  /** At least so bad. */
  level: LogLevel;
  node: string;
  text: string;
}

/** @param after only lines above this number. */
export const getLog = (query: LogQuery, after: number, count: number, signal: AbortSignal) =>
  answer(
    http.GET("/api/log", {
      params: { query: { ...query, after, count } },
      signal: within(QUICK_MS, signal),
    }),
  );
