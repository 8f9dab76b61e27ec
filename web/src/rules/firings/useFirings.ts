import { useCallback, useEffect, useState } from "react";
import { type ApiError, asApiError } from "../../api/errors";
import { getFirings } from "../../api/rulesClient";
import type { Firing } from "../../api/ruleTypes";
import { useLive } from "../context/RulesContext";

export interface Firings {
  firings: Firing[] | null;
  more: boolean;
  error: ApiError | null;
  older: () => void;
}

/** A burst of firings is read once. */
const REST_MS = 250;

/** The newest entries of the journal, read again whenever something happens. */
export function useFirings(count: number, rule: string | null): Firings {
  const { happened, rules } = useLive();
  const [found, setFound] = useState<{ of: string | null; list: Firing[]; more: boolean } | null>(
    null,
  );
  const [error, setError] = useState<ApiError | null>(null);
  const available = rules?.available ?? false;

  // biome-ignore lint/correctness/useExhaustiveDependencies: whatever happened is in the journal
  useEffect(() => {
    if (!available) return;
    let left = false;
    const timer = window.setTimeout(() => {
      getFirings(null, count, rule).then(
        (journal) => {
          if (left) return;
          setError(null);
          setFound((was) => {
            // What was read of the past stays, as long as it follows on.
            const oldest = journal.firings.at(-1)?.number ?? 0;
            const rest =
              was?.of === rule ? was.list.filter((firing) => firing.number < oldest) : [];
            return {
              of: rule,
              list: [...journal.firings, ...rest],
              more: rest.length > 0 ? (was?.more ?? false) : journal.more,
            };
          });
        },
        (failure: unknown) => {
          if (!left) setError(asApiError(failure));
        },
      );
    }, REST_MS);
    return () => {
      left = true;
      window.clearTimeout(timer);
    };
  }, [happened, available, count, rule]);

  const older = useCallback(() => {
    const oldest = found?.list.at(-1)?.number;
    if (oldest === undefined) return;
    getFirings(oldest, count, rule).then(
      (journal) =>
        setFound((was) =>
          was === null
            ? was
            : { ...was, list: [...was.list, ...journal.firings], more: journal.more },
        ),
      (failure: unknown) => setError(asApiError(failure)),
    );
  }, [found, count, rule]);

  return {
    firings: found?.of === rule ? found.list : null,
    more: found?.more ?? false,
    error,
    older,
  };
}
