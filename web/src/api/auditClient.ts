import { answer, given, http, QUICK_MS, within } from "./http";

/**
 * @param before only lines below this number; null from the newest.
 * @param text only lines that hold this.
 */
export const getAuditLog = (
  before: number | null,
  text: string,
  count: number,
  signal?: AbortSignal,
) =>
  answer(
    http.GET("/api/audit", {
      params: { query: given({ before, count, text: text === "" ? null : text }) },
      signal: within(QUICK_MS, signal),
    }),
  );

/** Where the whole log can be downloaded. */
export const AUDIT_EXPORT = "/api/audit/export";
