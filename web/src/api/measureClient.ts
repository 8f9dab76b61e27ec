import { answer, http, QUICK_MS, within } from "./http";
import type { MeasureSketch } from "./types";

/** Has a line of points shown in the scene, with what was pressed last; nothing is kept. */
export const measurePoints = (sketch: MeasureSketch, signal: AbortSignal) =>
  answer(http.POST("/api/measure", { body: sketch, signal: within(QUICK_MS, signal) }));
