import { useCallback, useEffect, useRef, useState } from "react";
import { type ApiError, asApiError } from "../../api/errors";
import { cancelBacktest, getBacktest, startBacktest } from "../../api/rulesClient";
import type { Backtest, Table } from "../../api/ruleTypes";

export interface BacktestRun {
  of: Table;
  id: string | null;
  answer: Backtest | null;
  error: ApiError | null;
}

const POLL_MS = 250;
const ENDED = new Set<Backtest["state"]>(["done", "failed", "canceled"]);

export const isOver = (run: BacktestRun): boolean =>
  run.error !== null || (run.answer !== null && ENDED.has(run.answer.state));

/** One back-test at a time; leaving the page cancels it. */
export function useBacktest() {
  const [run, setRun] = useState<BacktestRun | null>(null);
  const current = useRef<AbortController | null>(null);
  const open = useRef<string | null>(null);

  const cancel = useCallback(() => {
    current.current?.abort();
    current.current = null;
    const id = open.current;
    open.current = null;
    // It may have ended by itself in the meantime: then there is nothing to cancel.
    if (id !== null) cancelBacktest(id).catch(() => undefined);
    setRun(null);
  }, []);

  const start = useCallback((table: Table, recording: string, seconds: number) => {
    current.current?.abort();
    const mine = new AbortController();
    current.current = mine;
    setRun({ of: table, id: null, answer: null, error: null });
    const follow = async () => {
      const { id } = await startBacktest(table, recording, seconds);
      if (mine.signal.aborted) {
        await cancelBacktest(id);
        return;
      }
      open.current = id;
      for (;;) {
        const answer = await getBacktest(id, mine.signal);
        setRun({ of: table, id, answer, error: null });
        if (ENDED.has(answer.state)) break;
        await new Promise((resolve) => window.setTimeout(resolve, POLL_MS));
        if (mine.signal.aborted) return;
      }
      open.current = null;
    };
    follow().catch((failure: unknown) => {
      if (mine.signal.aborted) return;
      open.current = null;
      setRun({ of: table, id: null, answer: null, error: asApiError(failure) });
    });
  }, []);

  useEffect(() => cancel, [cancel]);
  return { run, start, cancel };
}
