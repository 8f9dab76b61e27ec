import { answer, http, QUICK_MS, within } from "./http";
import type { Table } from "./ruleTypes";

/** The monitor looks at the table first. */
const SLOW_MS = 15_000;

export interface DrillOptions {
  faults: string[];
  /** How many of them break in each drive. */
  faults_per_drive: number;
  /** Null for the one in which the robot drives now. */
  world: string | null;
  drives: number;
}

/** Whether this console can drill, what there is to choose from, and the newest drill. */
export const getDrillRoom = (signal: AbortSignal) =>
  answer(http.GET("/api/drills", { signal: within(QUICK_MS, signal) }));

export const startDrill = (table: Table, options: DrillOptions) =>
  answer(
    http.POST("/api/drills", {
      body: { table, ...options, seed: 1 },
      signal: within(SLOW_MS),
    }),
  );

export const getDrill = (id: string, signal: AbortSignal) =>
  answer(
    http.GET("/api/drills/{drill_id}", {
      params: { path: { drill_id: id } },
      signal: within(SLOW_MS, signal),
    }),
  );

export const cancelDrill = (id: string) =>
  answer(
    http.DELETE("/api/drills/{drill_id}", {
      params: { path: { drill_id: id } },
      signal: within(QUICK_MS),
    }),
  );

/** One scenario, driven under both tables. */
export const getDrillPair = (id: string, scenario: string, signal: AbortSignal) =>
  answer(
    http.GET("/api/drills/{drill_id}/drives/{scenario}", {
      params: { path: { drill_id: id, scenario } },
      signal: within(SLOW_MS, signal),
    }),
  );

/** Where all of it can be downloaded as one page. */
export const drillReportAddress = (id: string) => `/api/drills/${encodeURIComponent(id)}/report`;
