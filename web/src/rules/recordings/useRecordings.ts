import { useCallback, useEffect, useState } from "react";
import { type ApiError, asApiError } from "../../api/errors";
import { listRecordings } from "../../api/recordingsClient";
import type { RecordingList } from "../../api/ruleTypes";

export interface RecordingsHandle {
  list: RecordingList | null;
  error: ApiError | null;
  reload: () => void;
}

/** The robot keeps recordings by itself, too: looked at again while the page is open. */
const AGAIN_MS = 5000;

/** What is kept of the flight recorder, as long as somebody looks. */
export function useRecordings(): RecordingsHandle {
  const [list, setList] = useState<RecordingList | null>(null);
  const [error, setError] = useState<ApiError | null>(null);
  const [asked, setAsked] = useState(0);

  // biome-ignore lint/correctness/useExhaustiveDependencies: asked for again
  useEffect(() => {
    let left = false;
    let timer: number | undefined;
    const ask = () => {
      listRecordings()
        .then(
          (answer) => {
            if (left) return;
            setList(answer);
            setError(null);
          },
          (failure: unknown) => {
            if (!left) setError(asApiError(failure));
          },
        )
        .finally(() => {
          if (!left) timer = window.setTimeout(ask, AGAIN_MS);
        });
    };
    ask();
    return () => {
      left = true;
      window.clearTimeout(timer);
    };
  }, [asked]);

  const reload = useCallback(() => setAsked((count) => count + 1), []);
  return { list, error, reload };
}
