import { useEffect, useMemo, useState } from "react";
import { type ApiError, asApiError } from "../../api/errors";
import { checkRules, reportOf } from "../../api/rulesClient";
import type { CheckReport, Finding, TableView } from "../../api/ruleTypes";
import type { Draft } from "../changes/draft";
import { incomplete, sendable } from "../changes/findings";

export interface Check {
  /** Everything that is wrong or to think about, what is still missing first. */
  findings: Finding[];
  /** What the robot says of the newest draft; null while it is being asked. */
  report: CheckReport | null;
  error: ApiError | null;
  /** Whether it could be applied as far as anybody knows. */
  ok: boolean;
}

/** Asked once the hand rests. */
const REST_MS = 350;
/** A robot that could not answer is asked again. */
const AGAIN_MS = 1500;
const NONE: Finding[] = [];

/** What the robot says of the draft, asked again after every change. */
export function useCheck(draft: Draft | null, view: TableView | null): Check {
  const [answer, setAnswer] = useState<{
    of: Draft;
    report: CheckReport | null;
    error: ApiError | null;
  } | null>(null);
  const [tries, setTries] = useState(0);
  const revision = view?.revision;
  const table = draft?.table;

  // biome-ignore lint/correctness/useExhaustiveDependencies: a reason written is no other table
  useEffect(() => {
    if (draft === null) return;
    const asking = new AbortController();
    let timer = window.setTimeout(() => {
      checkRules(sendable(draft.table, draft.baseTable), asking.signal).then(
        (report) => setAnswer({ of: draft, report, error: null }),
        (error: unknown) => {
          if (asking.signal.aborted) return;
          const report = reportOf(error);
          setAnswer({ of: draft, report, error: report === null ? asApiError(error) : null });
          if (report === null) {
            timer = window.setTimeout(() => setTries((count) => count + 1), AGAIN_MS);
          }
        },
      );
    }, REST_MS);
    return () => {
      window.clearTimeout(timer);
      asking.abort();
    };
  }, [table, revision, tries]);

  return useMemo(() => {
    if (draft === null) {
      return { findings: view?.findings ?? NONE, report: null, error: null, ok: false };
    }
    const gaps = draft.table.rules.flatMap(incomplete);
    const told = answer?.report?.findings ?? NONE;
    const lacking = new Set(gaps.map((gap) => gap.rule_id));
    const findings = [...gaps, ...told.filter((finding) => !lacking.has(finding.rule_id))];
    const current = answer?.of.table === draft.table ? answer : null;
    return {
      findings,
      report: current?.report ?? null,
      error: current?.error ?? null,
      ok: current?.report?.ok === true && gaps.length === 0,
    };
  }, [draft, view, answer]);
}
