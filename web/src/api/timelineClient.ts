import { answer, CHANGE_MS, given, http, within } from "./http";
import type { Alarm } from "./ruleTypes";
import type { NoteSave, TimelineKind, TimelineLevel } from "./types";

const READ_MS = 8000;

/** Which entries are wanted; times in seconds since the epoch, 0 for any. */
export interface TimelineQuery {
  kinds: readonly TimelineKind[];
  level: TimelineLevel;
  text: string;
  since: number;
  until: number;
}

/**
 * @param before only entries below this number; null from the newest.
 * @param slots into how many parts of the time what happened is counted; 0 for none.
 */
export const getTimeline = (
  query: TimelineQuery,
  before: number | null,
  count: number,
  slots: number,
  signal?: AbortSignal,
) =>
  answer(
    http.GET("/api/timeline", {
      params: {
        query: given({ ...query, kinds: [...query.kinds], before, count, slots }),
      },
      signal: within(READ_MS, signal),
    }),
  );

export const addNote = (note: NoteSave) =>
  answer(http.POST("/api/timeline/notes", { body: note, signal: within(CHANGE_MS) }));

export const acknowledgeAlarm = ({ name, since }: Alarm) =>
  answer(
    http.POST("/api/timeline/alarms/acknowledge", {
      body: { alarm: name, since },
      signal: within(CHANGE_MS),
    }),
  );

/** @param seconds for which it is put away; 0 shows it again. */
export const shelveAlarm = (alarm: string, seconds: number) =>
  answer(
    http.POST("/api/timeline/alarms/shelve", {
      body: { alarm, seconds },
      signal: within(CHANGE_MS),
    }),
  );

/** Where the entries of that time can be downloaded. */
export const timelineExport = (since: number, until: number) =>
  `/api/timeline/export?since=${since}&until=${until}`;
