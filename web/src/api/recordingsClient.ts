import { request } from "./client";
import type { RecordingList, RecordingSaved } from "./ruleTypes";

/** A stretch is copied on the robot before it answers. */
const SAVING_MS = 65_000;

export const listRecordings = () => request<RecordingList>("GET", "/api/recordings");

/** @param seconds the last ones of the flight recorder; 0 for all it has. */
export const saveRecording = (seconds: number, name: string) =>
  request<RecordingSaved>("POST", "/api/recordings", {
    body: { seconds, name },
    timeoutMs: SAVING_MS,
  });

export const deleteRecording = (name: string) => request<void>("DELETE", recordingAddress(name));

/** Where the file can be downloaded. */
export const recordingAddress = (name: string) => `/api/recordings/${encodeURIComponent(name)}`;
