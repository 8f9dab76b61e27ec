import {
  hashKey,
  keepPreviousData,
  QueryClient,
  type QueryKey,
  useQuery,
} from "@tanstack/react-query";
import { useState } from "react";
import { type ApiError, asApiError } from "./errors";

declare module "@tanstack/react-query" {
  interface Register {
    defaultError: ApiError;
  }
}

/**
 * What the page asks of the console, and sends to it. Everything goes out at once, whatever the
 * browser thinks of its network, and a failure is told instead of tried again behind one's back.
 * An answer is forgotten with the last part of the page that shows it: the robot of before is never
 * shown as that of now. STOP and goals do not pass through here.
 */
export const createQueryClient = () =>
  new QueryClient({
    defaultOptions: {
      queries: {
        networkMode: "always",
        retry: false,
        gcTime: 0,
        refetchOnWindowFocus: false,
        refetchOnReconnect: false,
        refetchIntervalInBackground: true,
      },
      mutations: { networkMode: "always", retry: false, gcTime: 0 },
    },
  });

interface Question<T> {
  key: QueryKey;
  ask: (signal: AbortSignal) => Promise<T>;
  /** Whether it can be asked already. */
  enabled?: boolean;
  /** Milliseconds from an answer until it is asked again. */
  again?: number | ((data: T | undefined, error: ApiError | null) => number | false);
  /** Goes on showing the answer to the key before, until there is one. */
  keep?: boolean;
}

interface Answer<T> {
  data: T | null;
  /** Why the newest answer is missing: told until there is one, also while it is asked again. */
  error: ApiError | null;
  /** Whether `data` answers this key, and not the one before. */
  fresh: boolean;
}

/** Asks the console while somebody shows the answer; asked anew when the key changes. */
export function useAsked<T>({ key, ask, enabled = true, again, keep = false }: Question<T>) {
  const query = useQuery<T>({
    queryKey: key,
    queryFn: ({ signal }) =>
      ask(signal).catch((error: unknown) => {
        throw signal.aborted ? error : asApiError(error);
      }),
    enabled,
    refetchInterval:
      typeof again === "function"
        ? ({ state }) => again(state.data, state.error)
        : (again ?? false),
    ...(keep && { placeholderData: keepPreviousData }),
  });
  const of = hashKey(key);
  const [told, setTold] = useState<{ of: string; error: ApiError | null }>({ of, error: null });
  const before = told.of === of ? told.error : null;
  const error = query.isPending || query.isPlaceholderData ? before : query.error;
  if (told.of !== of || told.error !== error) setTold({ of, error });
  const answer: Answer<T> = { data: query.data ?? null, error, fresh: !query.isPlaceholderData };
  return answer;
}
