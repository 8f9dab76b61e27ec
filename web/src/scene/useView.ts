import { useCallback, useEffect, useMemo, useRef, useState } from "react";
import { createView, patchView } from "../api/client";
import { ApiError, asApiError } from "../api/errors";
import type { LayerKey, View, ViewPatch } from "../api/types";
import { useConnection } from "../state/RobotContext";
import { useTheme } from "../ui/theme";

export interface ViewHandle {
  view: View | null;
  error: ApiError | null;
  /** Changes the scene; shown at once, taken back when the console refuses. */
  change: (patch: ViewPatch) => void;
  toggleLayer: (key: LayerKey) => void;
  /** Shows a further topic of the robot, or shows it no more. */
  toggleExtra: (topic: string) => void;
}

/**
 * This page's scene on the server. The server may forget it (a restarted console): after every new
 * connection it is asked, and made again with the same layers and camera mode when it is gone.
 */
export function useView(): ViewHandle {
  const connection = useConnection();
  const { dark } = useTheme();
  const theme: View["theme"] = dark ? "dark" : "light";
  const [view, setView] = useState<View | null>(null);
  const [error, setError] = useState<ApiError | null>(null);
  const latest = useRef<View | null>(null);
  const wanted = useRef(theme);

  const take = useCallback((next: View) => {
    latest.current = next;
    setView(next);
    setError(null);
  }, []);

  useEffect(() => {
    wanted.current = theme;
  }, [theme]);

  useEffect(() => {
    if (connection === 0) return;
    let left = false;
    setUp(latest.current, wanted.current).then(
      (next) => {
        if (!left) take(next);
      },
      (failure: unknown) => {
        if (!left) setError(asApiError(failure));
      },
    );
    return () => {
      left = true;
    };
  }, [connection, take]);

  const change = useCallback(
    (patch: ViewPatch) => {
      const before = latest.current;
      if (before === null) return;
      take(merge(before, patch));
      patchView(before.id, patch).then(
        (next) => {
          // Only the answer to the newest change counts; a new scene answers for itself.
          if (latest.current?.id === next.id) take(next);
        },
        (failure: unknown) => {
          if (latest.current?.id !== before.id) return;
          take(before);
          setError(asApiError(failure));
        },
      );
    },
    [take],
  );

  // biome-ignore lint/correctness/useExhaustiveDependencies: a new scene starts with its own theme
  useEffect(() => {
    if (latest.current !== null && latest.current.theme !== theme) change({ theme });
  }, [theme, view?.id, change]);

  const toggleLayer = useCallback(
    (key: LayerKey) => {
      const layers = latest.current?.layers;
      if (layers !== undefined) change({ layers: { [key]: !layers[key] } });
    },
    [change],
  );

  const toggleExtra = useCallback(
    (topic: string) => {
      const extras = latest.current?.extras;
      if (extras === undefined) return;
      const without = extras.filter((each) => each !== topic);
      change({ extras: without.length < extras.length ? without : [...extras, topic] });
    },
    [change],
  );

  return useMemo(
    () => ({ view, error, change, toggleLayer, toggleExtra }),
    [view, error, change, toggleLayer, toggleExtra],
  );
}

async function setUp(known: View | null, theme: View["theme"]): Promise<View> {
  if (known === null) return patchView((await createView()).id, { theme });
  const { id, ...wishes } = known;
  try {
    return await patchView(id, wishes);
  } catch (error) {
    if (!(error instanceof ApiError && error.status === 404)) throw error;
    return patchView((await createView()).id, wishes);
  }
}

/** What the view will be once the server has taken `patch`. */
export function merge(view: View, patch: ViewPatch): View {
  const layers = { ...view.layers };
  for (const [key, on] of Object.entries(patch.layers ?? {})) {
    if (on !== null && on !== undefined) layers[key as LayerKey] = on;
  }
  return {
    id: view.id,
    follow: patch.follow ?? view.follow,
    top: patch.top ?? view.top,
    theme: patch.theme ?? view.theme,
    layers,
    extras: patch.extras ?? view.extras,
  };
}
