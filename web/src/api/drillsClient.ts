import type { components } from "../../generated/schema";
import type { Scenario } from "./drillTypes";
import { answer, http, QUICK_MS, within } from "./http";
import type { Table } from "./ruleTypes";

/** The monitor looks at the table first. */
const SLOW_MS = 15_000;

interface DrawnDrives {
  faults: string[];
  /** How many of them break in each drive. */
  faults_per_drive: number;
  /** Share of them that never end. */
  lasting: number;
  /** Null for the one in which the robot drives now. */
  world: string | null;
}

/** Drives that chance draws, or one of the person's own again and again. */
export type DrillOptions = { drives: number } & (DrawnDrives | { scenario: Scenario });

/** Whether this console can drill, what there is to choose from, and the newest drill. */
export const getDrillRoom = (signal: AbortSignal) =>
  answer(http.GET("/api/drills", { signal: within(QUICK_MS, signal) }));

/** The schema asks for what has a default, too. */
type Asked = components["schemas"]["DrillRequest"];

export const startDrill = (table: Table, options: DrillOptions) =>
  answer(
    http.POST("/api/drills", {
      body: { table, ...options, seed: 1 } as Asked,
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

/** A world from above. */
export const getDrillWorld = (name: string, signal: AbortSignal) =>
  answer(
    http.GET("/api/drills/worlds/{name}", {
      params: { path: { name } },
      signal: within(QUICK_MS, signal),
    }),
  );

/** The scenario that a file holds. */
export const readScenarioFile = (text: string) =>
  answer(
    http.POST("/api/drills/scenarios", {
      body: text,
      bodySerializer: (body) => body,
      headers: { "Content-Type": "text/plain" },
      signal: within(SLOW_MS),
    }),
  );

/** A stretch of a recording, s since its beginning; all of it where nothing is said. */
export interface Stretch {
  recording: string;
  begin?: number;
  end?: number;
}

/** What a kept recording becomes as a scenario. */
export const scenarioOfRecording = ({ recording, begin, end }: Stretch) =>
  answer(
    http.GET("/api/drills/scenarios/recorded/{recording}", {
      params: {
        path: { recording },
        query: { ...(begin === undefined ? {} : { begin }), ...(end === undefined ? {} : { end }) },
      },
      signal: within(60_000),
    }),
  );

/** Where a drive's scenario can be downloaded, to be driven again. */
export const scenarioAddress = (id: string, scenario: string) =>
  `/api/drills/${encodeURIComponent(id)}/files/${encodeURIComponent(scenario)}`;

/** Where all of it can be downloaded as one page. */
export const drillReportAddress = (id: string) => `/api/drills/${encodeURIComponent(id)}/report`;
