import { useCallback, useEffect, useMemo, useRef, useState } from "react";
import { removePreview } from "../api/client";
import { ApiError, asApiError } from "../api/errors";
import { measurePoints } from "../api/measureClient";
import type { GoalPick } from "../api/types";
import type { FloorPoint } from "./measureText";

/** A press on the flat map, and its release where it was a drag, m. */
export interface MeasureStroke {
  from: FloorPoint;
  to: FloorPoint | null;
}

export interface MeasureTool {
  active: boolean;
  points: readonly FloorPoint[];
  /** What was pressed last is not drawn yet. */
  waits: boolean;
  /** Why the last press gave no point; empty when it did. */
  problem: string;
  error: ApiError | null;
  toggle: () => void;
  draw: (pick: GoalPick | MeasureStroke) => void;
  set: (points: readonly FloorPoint[]) => void;
  /** Drops the points, else leaves the tool. Returns whether there was anything to leave. */
  back: () => boolean;
}

/** Measuring on the floor: each press is a point; answers are of the newest press only. */
export function useMeasureTool(viewId: string | null): MeasureTool {
  const [active, setActive] = useState(false);
  const [points, setPoints] = useState<readonly FloorPoint[]>([]);
  const [waits, setWaits] = useState(false);
  const [problem, setProblem] = useState("");
  const [error, setError] = useState<ApiError | null>(null);
  const asking = useRef<AbortController | null>(null);
  useEffect(() => () => asking.current?.abort(), []);

  const ask = useCallback(
    (before: readonly FloorPoint[], pick: GoalPick | null) => {
      if (viewId === null) return;
      asking.current?.abort();
      const mine = new AbortController();
      asking.current = mine;
      setWaits(true);
      const gesture = pick === null ? {} : { start: pick.start, end: pick.end ?? null };
      const sketch = { view: viewId, points: before.map(([x, y]): [number, number] => [x, y]) };
      measurePoints({ ...sketch, ...gesture }, mine.signal).then(
        (answer) => {
          if (asking.current !== mine) return;
          setPoints(answer.points.map(([x = 0, y = 0]) => [x, y]));
          setProblem(answer.problem);
          setError(null);
          setWaits(false);
        },
        (failure: unknown) => {
          if (asking.current !== mine) return;
          setError(asApiError(failure));
          setWaits(false);
        },
      );
    },
    [viewId],
  );

  const set = useCallback(
    (next: readonly FloorPoint[]) => {
      setPoints(next);
      ask(next, null);
    },
    [ask],
  );
  const draw = useCallback(
    (pick: GoalPick | MeasureStroke) => {
      if (!("from" in pick)) ask(points, pick);
      else if (pick.to === null) set([...points, pick.from]);
      else set(points.length === 0 ? [pick.from, pick.to] : [...points, pick.to]);
    },
    [ask, set, points],
  );
  const toggle = useCallback(() => {
    asking.current?.abort();
    asking.current = null;
    setActive(!active);
    setPoints([]);
    setProblem("");
    setError(null);
    setWaits(false);
    if (active && viewId !== null) {
      removePreview(viewId).catch((failure: unknown) => {
        // Only a drawing is left behind, and the next one replaces it.
        if (!(failure instanceof ApiError)) throw failure;
      });
    }
  }, [active, viewId]);
  const back = useCallback(() => {
    if (active && points.length > 0) set([]);
    else if (active) toggle();
    return active;
  }, [active, points, set, toggle]);

  return useMemo(
    () => ({ active, points, waits, problem, error, toggle, draw, set, back }),
    [active, points, waits, problem, error, toggle, draw, set, back],
  );
}
