import { useDebouncedValue } from "@mantine/hooks";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useEffect, useMemo } from "react";
import type { ApiError } from "../../api/errors";
import { useAsked } from "../../api/queries";
import { getFirings } from "../../api/rulesClient";
import type { Firing } from "../../api/ruleTypes";
import { useLive } from "../context/RulesContext";

interface Read {
  list: Firing[];
  more: boolean;
}

interface Firings {
  firings: Firing[] | null;
  more: boolean;
  error: ApiError | null;
  older: () => void;
}

/** A burst of firings is read once. */
const REST_MS = 250;

/** The newest entries of the journal, read again whenever something happens. */
export function useFirings(count: number, rule: string | null): Firings {
  const client = useQueryClient();
  const { happened, rules } = useLive();
  const [rested] = useDebouncedValue(happened, REST_MS);
  const key = useMemo(() => ["firings", count, rule], [count, rule]);
  const { data, error } = useAsked<Read>({
    key,
    enabled: rules?.available ?? false,
    ask: async (signal) => {
      const { firings, more } = await getFirings(null, count, rule, signal);
      // What was read of the past stays, as long as it follows on.
      const was = client.getQueryData<Read>(key);
      const oldest = firings.at(-1)?.number ?? 0;
      const rest = was?.list.filter((firing) => firing.number < oldest) ?? [];
      return { list: [...firings, ...rest], more: rest.length > 0 ? was?.more === true : more };
    },
  });

  // biome-ignore lint/correctness/useExhaustiveDependencies: whatever happened is in the journal
  useEffect(() => {
    void client.invalidateQueries({ queryKey: key });
  }, [rested, client, key]);

  const older = useMutation({
    mutationFn: (before: number) => getFirings(before, count, rule),
    onSuccess: ({ firings, more }) =>
      client.setQueryData<Read>(key, (was) => was && { list: [...was.list, ...firings], more }),
  });

  return {
    firings: data?.list ?? null,
    more: data?.more ?? false,
    error: error ?? older.error,
    older: () => {
      const oldest = data?.list.at(-1)?.number;
      if (oldest !== undefined) older.mutate(oldest);
    },
  };
}
