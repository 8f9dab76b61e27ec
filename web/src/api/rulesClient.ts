import { ApiError } from "./errors";
import { answer, given, http, QUICK_MS, within } from "./http";
import type { CheckReport, Conflict, Table } from "./ruleTypes";

/** What the monitor may take for an answer that compares, stores or compiles whole tables. */
const SLOW_MS = 15_000;

/** The table in force. */
export const getRules = (signal: AbortSignal) =>
  answer(http.GET("/api/rules", { signal: within(SLOW_MS, signal) }));

export const checkRules = (table: Table, signal: AbortSignal) =>
  answer(http.POST("/api/rules/check", { body: { table }, signal: within(SLOW_MS, signal) }));

export interface ApplyOptions {
  expectedRevision: number;
  reason: string;
  /** Seconds; 0 for no probation. */
  probation: number;
  cancelRunning: boolean;
}

export const applyRules = (table: Table, options: ApplyOptions) =>
  answer(
    http.POST("/api/rules/apply", {
      body: {
        table,
        expected_revision: options.expectedRevision,
        reason: options.reason,
        probation: options.probation,
        cancel_running: options.cancelRunning,
        reset: [],
      },
      signal: within(SLOW_MS),
    }),
  );

export const confirmRules = (revision: number) =>
  answer(http.POST("/api/rules/confirm", { body: { revision }, signal: within(SLOW_MS) }));

/** @param revision whose table to restore; null for the one before the one in force. */
export const rollbackRules = (revision: number | null, expectedRevision: number, reason: string) =>
  answer(
    http.POST("/api/rules/rollback", {
      body: { revision, expected_revision: expectedRevision, reason, cancel_running: false },
      signal: within(SLOW_MS),
    }),
  );

export const resetRule = (id: string) =>
  answer(
    http.POST("/api/rules/{rule_id}/reset", {
      params: { path: { rule_id: id } },
      signal: within(SLOW_MS),
    }),
  );

/** Which run of a rule: its number, and in which life of the monitor. */
export interface Run {
  run_id: number;
  epoch: string;
}

/** Why a rule fires or not, now; or why it did, for one of its runs. */
export const explainRule = (id: string, run: Run | null, signal: AbortSignal) =>
  answer(
    http.GET("/api/rules/{rule_id}/explain", {
      params: { path: { rule_id: id }, query: run ?? {} },
      signal: within(SLOW_MS, signal),
    }),
  );

/** @param before a revision; the newest ones when it is null. */
export const getHistory = (before: number | null, count: number, signal?: AbortSignal) =>
  answer(
    http.GET("/api/rules/history", {
      params: { query: given({ before, count }) },
      signal: within(SLOW_MS, signal),
    }),
  );

export const diffRules = (from: number, to: number, signal: AbortSignal) =>
  answer(
    http.GET("/api/rules/diff", {
      params: { query: { from, to } },
      signal: within(SLOW_MS, signal),
    }),
  );

/** @param before the number of an entry; the newest ones when it is null. */
export const getFirings = (
  before: number | null,
  count: number,
  ruleId: string | null,
  signal?: AbortSignal,
) =>
  answer(
    http.GET("/api/firings", {
      params: { query: given({ before, count, rule_id: ruleId }) },
      signal: within(SLOW_MS, signal),
    }),
  );

export const getGraph = (signal: AbortSignal) =>
  answer(http.GET("/api/graph", { signal: within(SLOW_MS, signal) }));

/** Where the table in force can be downloaded. */
export const exportAddress = (format: "json" | "yaml" | "python") =>
  `/api/rules/export?format=${format}`;

/**
 * @param recording name of one that was kept; empty for the flight recorder's newest minutes.
 * @param seconds the last ones of it; 0 for all there is.
 */
export const startBacktest = (table: Table, recording: string, seconds: number) =>
  answer(
    http.POST("/api/backtests", { body: { table, recording, seconds }, signal: within(SLOW_MS) }),
  );

export const getBacktest = (id: string, signal: AbortSignal) =>
  answer(
    http.GET("/api/backtests/{backtest_id}", {
      params: { path: { backtest_id: id } },
      signal: within(SLOW_MS, signal),
    }),
  );

export const cancelBacktest = (id: string) =>
  answer(
    http.DELETE("/api/backtests/{backtest_id}", {
      params: { path: { backtest_id: id } },
      signal: within(QUICK_MS),
    }),
  );

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
