import { request } from "./client";
import { ApiError } from "./errors";
import type {
  ApplyReport,
  Backtest,
  CheckReport,
  Conflict,
  Explanation,
  Graph,
  History,
  Journal,
  Table,
  TableDiff,
  TableView,
} from "./ruleTypes";

/** What the monitor may take for an answer that compares, stores or compiles whole tables. */
const SLOW_MS = 15_000;

/** The table in force, or that of a revision. */
export const getRules = (revision?: number) =>
  request<TableView>("GET", `/api/rules${revision === undefined ? "" : `?revision=${revision}`}`, {
    timeoutMs: SLOW_MS,
  });

export const checkRules = (table: Table, signal?: AbortSignal) =>
  request<CheckReport>("POST", "/api/rules/check", {
    body: { table },
    timeoutMs: SLOW_MS,
    ...(signal && { signal }),
  });

export interface ApplyOptions {
  expectedRevision: number;
  reason: string;
  /** Seconds; 0 for no probation. */
  probation: number;
  cancelRunning: boolean;
  reset: string[];
}

export const applyRules = (table: Table, options: ApplyOptions) =>
  request<ApplyReport>("POST", "/api/rules/apply", {
    body: {
      table,
      expected_revision: options.expectedRevision,
      reason: options.reason,
      probation: options.probation,
      cancel_running: options.cancelRunning,
      reset: options.reset,
    },
    timeoutMs: SLOW_MS,
  });

export const confirmRules = (revision: number) =>
  request<unknown>("POST", "/api/rules/confirm", { body: { revision }, timeoutMs: SLOW_MS });

/** @param revision whose table to restore; null for the one before the one in force. */
export const rollbackRules = (revision: number | null, expectedRevision: number, reason: string) =>
  request<ApplyReport>("POST", "/api/rules/rollback", {
    body: { revision, expected_revision: expectedRevision, reason, cancel_running: false },
    timeoutMs: SLOW_MS,
  });

export const resetRule = (id: string) =>
  request<unknown>("POST", `/api/rules/${encodeURIComponent(id)}/reset`, { timeoutMs: SLOW_MS });

/** Why a rule fires or not, now; or why it did, for a run of a life of the monitor. */
export const explainRule = (id: string, run?: { run_id: number; epoch: string }) =>
  request<Explanation>(
    "GET",
    `/api/rules/${encodeURIComponent(id)}/explain${
      run === undefined ? "" : `?run_id=${run.run_id}&epoch=${encodeURIComponent(run.epoch)}`
    }`,
    { timeoutMs: SLOW_MS },
  );

export const getHistory = (before: number | null, count: number) =>
  request<History>(
    "GET",
    `/api/rules/history?count=${count}${before === null ? "" : `&before=${before}`}`,
    { timeoutMs: SLOW_MS },
  );

export const diffRules = (from: number, to: number) =>
  request<TableDiff>("GET", `/api/rules/diff?from=${from}&to=${to}`, { timeoutMs: SLOW_MS });

export const getFirings = (before: number | null, count: number, ruleId: string | null) => {
  const query = new URLSearchParams({ count: String(count) });
  if (before !== null) query.set("before", String(before));
  if (ruleId !== null) query.set("rule_id", ruleId);
  return request<Journal>("GET", `/api/firings?${query}`, { timeoutMs: SLOW_MS });
};

export const getGraph = () => request<Graph>("GET", "/api/graph", { timeoutMs: SLOW_MS });

/** Where the table in force can be downloaded. */
export const exportAddress = (format: "json" | "yaml" | "python") =>
  `/api/rules/export?format=${format}`;

/**
 * @param recording name of one that was kept; empty for the flight recorder's newest minutes.
 * @param seconds the last ones of it; 0 for all there is.
 */
export const startBacktest = (table: Table, recording: string, seconds: number) =>
  request<{ id: string }>("POST", "/api/backtests", {
    body: { table, recording, seconds },
    timeoutMs: SLOW_MS,
  });

export const getBacktest = (id: string, signal: AbortSignal) =>
  request<Backtest>("GET", `/api/backtests/${encodeURIComponent(id)}`, {
    signal,
    timeoutMs: SLOW_MS,
  });

export const cancelBacktest = (id: string) =>
  request<unknown>("DELETE", `/api/backtests/${encodeURIComponent(id)}`);

/** What somebody else changed meanwhile, when that is why a change was refused. */
export function conflictOf(error: unknown): Conflict | null {
  return error instanceof ApiError && error.status === 409
    ? (part(error.body, "conflict") as Conflict | null)
    : null;
}

/** What is wrong with the table, when that is why it was refused. */
export function reportOf(error: unknown): CheckReport | null {
  return error instanceof ApiError && error.status === 422
    ? (part(error.body, "report") as CheckReport | null)
    : null;
}

function part(body: unknown, name: string): unknown {
  return typeof body === "object" && body !== null && name in body
    ? ((body as Record<string, unknown>)[name] ?? null)
    : null;
}
