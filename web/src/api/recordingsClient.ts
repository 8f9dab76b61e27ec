import { answer, http, QUICK_MS, within } from "./http";

/** A stretch is copied on the robot before it answers. */
const SAVING_MS = 65_000;

export const listRecordings = (signal: AbortSignal) =>
  answer(http.GET("/api/recordings", { signal: within(QUICK_MS, signal) }));

/** @param seconds the last ones of the flight recorder; 0 for all it has. */
export const saveRecording = (seconds: number, name: string) =>
  answer(http.POST("/api/recordings", { body: { seconds, name }, signal: within(SAVING_MS) }));

export const deleteRecording = (name: string) =>
  answer(
    http.DELETE("/api/recordings/{name}", {
      params: { path: { name } },
      signal: within(QUICK_MS),
    }),
  );

/** Where the file can be downloaded. */
export const recordingAddress = (name: string) => `/api/recordings/${encodeURIComponent(name)}`;
