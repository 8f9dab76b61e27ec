import { useDebouncedValue } from "@mantine/hooks";
import { useMemo } from "react";
import type { ApiError } from "../../api/errors";
import { useAsked } from "../../api/queries";
import { checkRules, reportOf } from "../../api/rulesClient";
import type { CheckReport, Finding, Table, TableView } from "../../api/ruleTypes";
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
/** What all questions of this kind begin with. */
export const CHECK = ["check"];
const NONE: Finding[] = [];

/** A table that is refused has an answer all the same: the report that says why. */
async function check(table: Table, signal: AbortSignal): Promise<CheckReport> {
  try {
    return await checkRules(table, signal);
  } catch (error) {
    const report = reportOf(error);
    if (report === null) throw error;
    return report;
  }
}

/** What the robot says of the draft, asked again after every change. */
export function useCheck(draft: Draft | null, view: TableView | null): Check {
  const [rested] = useDebouncedValue(draft, REST_MS);
  const text = useMemo(
    () => rested && JSON.stringify(sendable(rested.table, rested.baseTable)),
    [rested],
  );
  const { data, error, fresh } = useAsked({
    key: [...CHECK, text, view?.revision],
    enabled: text !== null,
    ask: (signal) => check(JSON.parse(text ?? ""), signal),
    again: (_, failure) => (failure === null ? false : AGAIN_MS),
    keep: true,
  });
  const current = fresh && rested?.table === draft?.table;

  return useMemo(() => {
    if (draft === null) {
      return { findings: view?.findings ?? NONE, report: null, error: null, ok: false };
    }
    const gaps = draft.table.rules.flatMap(incomplete);
    const told = data?.findings ?? NONE;
    const lacking = new Set(gaps.map((gap) => gap.rule_id));
    const findings = [...gaps, ...told.filter((finding) => !lacking.has(finding.rule_id))];
    const report = current ? data : null;
    return {
      findings,
      report,
      error: current ? error : null,
      ok: report?.ok === true && gaps.length === 0,
    };
  }, [draft, view, data, error, current]);
}
