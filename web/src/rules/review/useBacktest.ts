import { useMutation } from "@tanstack/react-query";
import { useCallback, useEffect, useRef } from "react";
import type { ApiError } from "../../api/errors";
import { useAsked } from "../../api/queries";
import { cancelBacktest, getBacktest, startBacktest } from "../../api/rulesClient";
import type { Backtest, Table } from "../../api/ruleTypes";

export interface BacktestRun {
  of: Table;
  answer: Backtest | null;
  error: ApiError | null;
  over: boolean;
}

interface Order {
  table: Table;
  recording: string;
  seconds: number;
  /** Aborted when nobody waits for it any more. */
  left: AbortSignal;
}

const POLL_MS = 250;
const ENDED = new Set<Backtest["state"]>(["done", "failed", "canceled"]);

/** Has the robot try a table, and calls it off as soon as nobody waits for it. */
async function order({ table, recording, seconds, left }: Order): Promise<string> {
  const { id } = await startBacktest(table, recording, seconds);
  // It may have ended by itself in the meantime: then there is nothing to cancel.
  const callOff = () => void cancelBacktest(id).catch(() => undefined);
  if (left.aborted) callOff();
  left.addEventListener("abort", callOff);
  return id;
}

/** One back-test at a time; leaving the page cancels it. */
export function useBacktest() {
  const current = useRef<AbortController | null>(null);
  const { mutate, reset, variables, data: id, error: refused } = useMutation({ mutationFn: order });
  const { data: answer, error: lost } = useAsked({
    key: ["backtest", id],
    enabled: id !== undefined,
    ask: (signal) => getBacktest(id ?? "", signal),
    again: (newest, failure) =>
      failure !== null || (newest !== undefined && ENDED.has(newest.state)) ? false : POLL_MS,
  });
  const error = refused ?? lost;
  const over = error !== null || (answer !== null && ENDED.has(answer.state));
  useEffect(() => {
    if (over) current.current = null;
  }, [over]);

  const leave = useCallback(() => {
    current.current?.abort();
    current.current = null;
  }, []);
  useEffect(() => leave, [leave]);

  const start = (table: Table, recording: string, seconds: number) => {
    leave();
    current.current = new AbortController();
    mutate({ table, recording, seconds, left: current.current.signal });
  };
  const cancel = () => {
    leave();
    reset();
  };
  const run: BacktestRun | null =
    variables === undefined ? null : { of: variables.table, answer, error, over };
  return { run, start, cancel };
}
