import { useCallback, useEffect, useMemo, useRef, useState } from "react";
import { removePreview } from "../api/client";
import { ApiError, asApiError } from "../api/errors";
import type { GoalPick, Zone } from "../api/types";
import { sketchZone } from "../api/zonesClient";
import { asCorners, type Corner, drawn } from "./zoneText";

export interface ZoneTool {
  active: boolean;
  /** The zone that is changed; null for a new one. */
  zone: Zone | null;
  corners: readonly Corner[];
  /** Why the corners make no zone yet; empty when they do, null while that is looked at. */
  problem: string | null;
  /** Who would be in it as it is drawn. */
  inside: Inside;
  error: ApiError | null;
  /** Begins a new zone, or to change one. */
  begin: (zone: Zone | null) => void;
  /** A press on the scene, a drag, or points of the floor. */
  draw: (pick: GoalPick | ZoneStroke) => void;
  set: (corners: readonly Corner[]) => void;
  leave: () => void;
  /** Leaves the tool. Returns whether there was anything to leave. */
  back: () => boolean;
}

export interface Inside {
  robot: boolean;
  places: readonly string[];
}

const NOBODY: Inside = { robot: false, places: [] };

/** A press on the floor, and its release where it was a drag, m. */
export interface ZoneStroke {
  from: Corner;
  to: Corner | null;
}

/** Drawing a zone: each press is a corner; answers are of the newest corners only. */
export function useZoneTool(viewId: string | null): ZoneTool {
  const [active, setActive] = useState(false);
  const [zone, setZone] = useState<Zone | null>(null);
  const [corners, setCorners] = useState<readonly Corner[]>([]);
  const [problem, setProblem] = useState<string | null>("");
  const [inside, setInside] = useState(NOBODY);
  const [error, setError] = useState<ApiError | null>(null);
  const asking = useRef<AbortController | null>(null);
  useEffect(() => () => asking.current?.abort(), []);

  const ask = useCallback(
    (before: readonly Corner[], pick: GoalPick | null) => {
      asking.current?.abort();
      const mine = new AbortController();
      asking.current = mine;
      setProblem(null);
      const gesture = pick === null ? {} : { start: pick.start, end: pick.end ?? null };
      const sketch = { view: viewId, corners: before.map(([x, y]): [number, number] => [x, y]) };
      sketchZone({ ...sketch, ...gesture }, mine.signal).then(
        (answer) => {
          if (asking.current !== mine) return;
          setCorners(asCorners(answer.corners));
          setProblem(answer.problem);
          setInside({ robot: answer.robot_inside, places: answer.places_inside });
          setError(null);
        },
        (failure: unknown) => {
          if (asking.current !== mine) return;
          setError(asApiError(failure));
          setProblem("");
        },
      );
    },
    [viewId],
  );

  const set = useCallback(
    (next: readonly Corner[]) => {
      setCorners(next);
      ask(next, null);
    },
    [ask],
  );
  const begin = useCallback(
    (before: Zone | null) => {
      setActive(true);
      setZone(before);
      setError(null);
      set(asCorners(before?.corners ?? []));
    },
    [set],
  );
  const draw = useCallback(
    (pick: GoalPick | ZoneStroke) => {
      if ("from" in pick) set(drawn(corners, pick.from, pick.to));
      else ask(corners, pick);
    },
    [ask, set, corners],
  );
  const leave = useCallback(() => {
    asking.current?.abort();
    asking.current = null;
    setActive(false);
    setZone(null);
    setCorners([]);
    setInside(NOBODY);
    if (viewId !== null) {
      removePreview(viewId).catch((failure: unknown) => {
        // Only a drawing is left behind, and the next check replaces it.
        if (!(failure instanceof ApiError)) throw failure;
      });
    }
  }, [viewId]);
  const back = useCallback(() => {
    if (active) leave();
    return active;
  }, [active, leave]);

  return useMemo(
    () => ({ active, zone, corners, problem, inside, error, begin, draw, set, leave, back }),
    [active, zone, corners, problem, inside, error, begin, draw, set, leave, back],
  );
}
