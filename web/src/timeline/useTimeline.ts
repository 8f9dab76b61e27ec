import { useDebouncedValue } from "@mantine/hooks";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useEffect, useMemo } from "react";
import type { ApiError } from "../api/errors";
import { useAsked } from "../api/queries";
import { getTimeline, type TimelineQuery } from "../api/timelineClient";
import type { TimelineEntry, TimelinePage } from "../api/types";
import { useRobot } from "../state/RobotContext";

const PAGE = 60;
/** What happens in a burst is read once. */
const REST_MS = 500;

interface Timeline {
  page: TimelinePage | null;
  /** Whether it answers this question, and not the one before. */
  fresh: boolean;
  error: ApiError | null;
  older: { ask: () => void; pending: boolean };
}

/** What has happened in a time, newest first, read again whenever something does. */
export function useTimeline(query: TimelineQuery, slots: number): Timeline {
  const client = useQueryClient();
  const { state } = useRobot();
  const [changes] = useDebouncedValue(state?.timeline.changes ?? 0, REST_MS);
  const asked = JSON.stringify(query);
  const key = useMemo(() => ["timeline", asked, slots], [asked, slots]);
  const { data, error, fresh } = useAsked<TimelinePage>({
    key,
    keep: true,
    ask: async (signal) => {
      const page = await getTimeline(query, null, PAGE, slots, signal);
      // What was read of the past stays, as long as it follows on.
      const was = client.getQueryData<TimelinePage>(key);
      const oldest = page.entries.at(-1)?.number ?? 0;
      const rest = was?.entries.filter(({ number }) => number < oldest) ?? [];
      return rest.length === 0
        ? page
        : { ...page, entries: [...page.entries, ...rest], more: was?.more === true };
    },
  });

  // biome-ignore lint/correctness/useExhaustiveDependencies: a change is what is to be read
  useEffect(() => {
    void client.invalidateQueries({ queryKey: key });
  }, [changes, client, key]);

  const older = useMutation({
    mutationFn: (before: number) => getTimeline(query, before, PAGE, 0),
    onSuccess: ({ entries, more }) =>
      client.setQueryData<TimelinePage>(
        key,
        (was) => was && { ...was, entries: [...was.entries, ...entries], more },
      ),
  });
  const last: TimelineEntry | undefined = data?.entries.at(-1);
  return {
    page: data,
    fresh,
    error: error ?? older.error,
    older: {
      ask: () => last !== undefined && older.mutate(last.number),
      pending: older.isPending,
    },
  };
}
