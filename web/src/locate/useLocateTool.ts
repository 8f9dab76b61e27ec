import { useCallback, useEffect, useMemo, useRef, useState } from "react";
import { checkRobotPose, removePreview, setRobotPose } from "../api/client";
import { ApiError, asApiError } from "../api/errors";
import type { GoalPick, GoalPoint, LocateCheck, RobotPose } from "../api/types";
import type { Anchor } from "../goal/GestureOverlay";

/** A place that is being considered, or was told to the robot. */
export interface LocateDraft {
  /** Where the hand is; null when the coordinates were typed. */
  anchor: Anchor | null;
  phase: "checking" | "checked" | "sending" | "told";
  check: LocateCheck | null;
  error: ApiError | null;
}

export interface LocateTool {
  active: boolean;
  typing: boolean;
  draft: LocateDraft | null;
  /** How well scan and map agree where the pointer is dragged to now; null while nothing is. */
  looked: number | null;
  toggle: () => void;
  type: (open: boolean) => void;
  /** While it is dragged: shows the scan as it would lie. */
  look: (pick: GoalPick | GoalPoint) => void;
  check: (place: GoalPick | GoalPoint, anchor: Anchor | null) => void;
  /** Tells the robot the best place of the check, or the very one that was pressed. */
  set: (exactly?: boolean) => void;
  /** Drops the draft, else leaves the tool. Returns whether there was anything to leave. */
  back: () => boolean;
  drop: () => void;
}

/** Saying where the robot is: dragged, compared, then told. Answers are of the newest pick only. */
export function useLocateTool(viewId: string | null): LocateTool {
  const [active, setActive] = useState(false);
  const [typing, setTyping] = useState(false);
  const [draft, setDraft] = useState<LocateDraft | null>(null);
  const [looked, setLooked] = useState<number | null>(null);
  const asking = useRef<AbortController | null>(null);
  // One look at a time, each at what is newest by then: a drag never queues up.
  const wanted = useRef<GoalPick | GoalPoint | null>(null);
  const looking = useRef(false);
  useEffect(
    () => () => {
      wanted.current = null;
      asking.current?.abort();
    },
    [],
  );

  const settle = useCallback(() => {
    wanted.current = null;
    asking.current?.abort();
    asking.current = null;
    setLooked(null);
  }, []);

  const drop = useCallback(() => {
    settle();
    setDraft(null);
    if (viewId !== null) {
      removePreview(viewId).catch((error: unknown) => {
        // Only a drawing is left behind, and the next check replaces it.
        if (!(error instanceof ApiError)) throw error;
      });
    }
  }, [viewId, settle]);

  const look = useCallback(async (pick: GoalPick | GoalPoint) => {
    wanted.current = pick;
    if (looking.current) return;
    looking.current = true;
    const mine = new AbortController();
    asking.current?.abort();
    asking.current = mine;
    setDraft(null);
    try {
      while (wanted.current !== null && !mine.signal.aborted) {
        const next: GoalPick | GoalPoint = wanted.current;
        wanted.current = null;
        const answer = await checkRobotPose({ ...next, search: false }, mine.signal);
        if (!mine.signal.aborted) setLooked(answer.here?.agreement ?? null);
      }
    } catch (error: unknown) {
      // The release asks again, and its card says what is wrong.
      if (!mine.signal.aborted) asApiError(error);
    } finally {
      looking.current = false;
    }
  }, []);

  const check = useCallback(
    (place: GoalPick | GoalPoint, anchor: Anchor | null) => {
      settle();
      const mine = new AbortController();
      asking.current = mine;
      setDraft({ anchor, phase: "checking", check: null, error: null });
      checkRobotPose({ ...place, search: true }, mine.signal).then(
        (answer) => {
          if (asking.current !== mine) return;
          setDraft({ anchor, phase: "checked", check: answer, error: null });
        },
        (error: unknown) => {
          if (asking.current !== mine) return;
          setDraft({ anchor, phase: "checked", check: null, error: asApiError(error) });
        },
      );
    },
    [settle],
  );

  const set = useCallback(
    (exactly = false) => {
      const found = draft?.check;
      if (draft?.phase !== "checked" || !found?.ok) return;
      const chosen = exactly ? found.here : (found.best ?? found.here);
      if (chosen === null || chosen === undefined) return;
      const place: RobotPose = { x: chosen.x, y: chosen.y, yaw: chosen.yaw };
      const mine = new AbortController();
      asking.current = mine;
      setDraft({ ...draft, phase: "sending", error: null });
      setRobotPose(place).then(
        () => {
          if (asking.current !== mine) return;
          drop();
          setDraft({ ...draft, phase: "told", error: null });
        },
        (error: unknown) => {
          if (asking.current === mine) setDraft({ ...draft, error: asApiError(error) });
        },
      );
    },
    [draft, drop],
  );

  const leave = useCallback(() => {
    drop();
    setTyping(false);
    setActive(false);
  }, [drop]);

  const toggle = useCallback(() => {
    if (active) leave();
    else setActive(true);
  }, [active, leave]);

  const back = useCallback(() => {
    if (draft?.phase === "told") leave();
    else if (draft !== null) drop();
    else if (typing) setTyping(false);
    else if (active) leave();
    else return false;
    return true;
  }, [draft, typing, active, drop, leave]);

  return useMemo(
    () => ({
      active,
      typing,
      draft,
      looked,
      toggle,
      type: setTyping,
      look: (pick: GoalPick | GoalPoint) => void look(pick),
      check,
      set,
      back,
      drop,
    }),
    [active, typing, draft, looked, toggle, look, check, set, back, drop],
  );
}
