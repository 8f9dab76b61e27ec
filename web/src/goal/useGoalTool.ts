import { useCallback, useEffect, useMemo, useRef, useState } from "react";
import { checkGoal, removePreview, sendGoal } from "../api/client";
import { ApiError, asApiError } from "../api/errors";
import type { GoalCheck, GoalPick, GoalPoint, Place, PlaceGoal } from "../api/types";
import type { Anchor } from "./GestureOverlay";

/** A goal that is being prepared: not sent, or its sending was refused. */
export interface Draft {
  /** Where the hand is; null when the coordinates were typed. */
  anchor: Anchor | null;
  /** The place that it is; null for a point. */
  place: Place | null;
  phase: "checking" | "checked" | "sending";
  check: GoalCheck | null;
  error: ApiError | null;
}

export interface GoalTool {
  active: boolean;
  typing: boolean;
  draft: Draft | null;
  toggle: () => void;
  type: (open: boolean) => void;
  check: (goal: GoalPick | GoalPoint, anchor: Anchor | null) => void;
  /** Looks at the way to a place; `go` then sends the robot there. */
  checkPlace: (place: Place) => void;
  /** Sends the checked goal. */
  go: () => void;
  /** Sends the nearest reachable point instead. */
  goNearest: () => void;
  /** Drops the draft, else leaves the tool. Returns whether there was anything to leave. */
  back: () => boolean;
  drop: () => void;
}

/** Most goals are sent in less. A button that turns, and goes at once, takes the page longer to
 * draw than the console to answer, and would be drawn before the goal is sent. */
export const SAY_SENDING_AFTER_MS = 150;

/** The goal tool: pick, check, then send; each answer belongs to the newest pick only. */
export function useGoalTool(viewId: string | null): GoalTool {
  const [active, setActive] = useState(false);
  const [typing, setTyping] = useState(false);
  const [draft, setDraft] = useState<Draft | null>(null);
  const asking = useRef<AbortController | null>(null);
  const sending = useRef<AbortController | null>(null);
  useEffect(() => () => asking.current?.abort(), []);

  const drop = useCallback(() => {
    asking.current?.abort();
    asking.current = null;
    setDraft(null);
    if (viewId !== null) {
      removePreview(viewId).catch((error: unknown) => {
        // Only a drawing is left behind, and the next check replaces it.
        if (!(error instanceof ApiError)) throw error;
      });
    }
  }, [viewId]);

  const ask = useCallback(
    (goal: GoalPick | GoalPoint | PlaceGoal, of: Pick<Draft, "anchor" | "place">) => {
      asking.current?.abort();
      const mine = new AbortController();
      asking.current = mine;
      setDraft({ ...of, phase: "checking", check: null, error: null });
      checkGoal(goal, mine.signal).then(
        (answer) => {
          if (asking.current !== mine) return;
          setDraft({ ...of, phase: "checked", check: answer, error: null });
        },
        (error: unknown) => {
          if (asking.current !== mine) return;
          setDraft({ ...of, phase: "checked", check: null, error: asApiError(error) });
        },
      );
    },
    [],
  );

  const check = useCallback(
    (goal: GoalPick | GoalPoint, anchor: Anchor | null) => ask(goal, { anchor, place: null }),
    [ask],
  );

  const checkPlace = useCallback(
    (place: Place) => ask({ ...placeGoal(place), view: viewId }, { anchor: null, place }),
    [ask, viewId],
  );

  const send = useCallback(
    (goal: GoalPoint | PlaceGoal, from: Draft) => {
      if (sending.current !== null && sending.current === asking.current) return;
      const mine = new AbortController();
      asking.current = mine;
      sending.current = mine;
      const late = window.setTimeout(() => {
        if (asking.current === mine) setDraft({ ...from, phase: "sending", error: null });
      }, SAY_SENDING_AFTER_MS);
      const settled = () => {
        window.clearTimeout(late);
        if (sending.current === mine) sending.current = null;
        return asking.current === mine;
      };
      sendGoal(viewId === null ? goal : { ...goal, view: viewId }).then(
        () => {
          if (!settled()) return;
          setDraft(null);
          setTyping(false);
          setActive(false);
        },
        (error: unknown) => {
          if (settled()) setDraft({ ...from, error: asApiError(error) });
        },
      );
    },
    [viewId],
  );

  const go = useCallback(() => {
    if (draft?.phase !== "checked" || !draft.check?.ok) return;
    const { x, y, yaw } = draft.check;
    send(draft.place === null ? { x, y, yaw } : placeGoal(draft.place), draft);
  }, [draft, send]);

  const goNearest = useCallback(() => {
    const nearest = draft?.check?.nearest;
    if (draft?.phase !== "checked" || !nearest) return;
    send({ x: nearest.x, y: nearest.y, yaw: draft.check?.yaw ?? null }, draft);
  }, [draft, send]);

  const leave = useCallback(() => {
    if (draft !== null) drop();
    setTyping(false);
    setActive(false);
  }, [draft, drop]);

  const toggle = useCallback(() => {
    if (active) leave();
    else setActive(true);
  }, [active, leave]);

  const back = useCallback(() => {
    if (draft !== null) drop();
    else if (typing) setTyping(false);
    else if (active) setActive(false);
    else return false;
    return true;
  }, [draft, typing, active, drop]);

  return useMemo(
    () => ({
      active,
      typing,
      draft,
      toggle,
      type: setTyping,
      check,
      checkPlace,
      go,
      goNearest,
      back,
      drop,
    }),
    [active, typing, draft, toggle, check, checkPlace, go, goNearest, back, drop],
  );
}

const placeGoal = (place: Place): PlaceGoal => ({ place: place.id, version: place.version });
