import { type Dispatch, useCallback, useEffect, useRef } from "react";
import { asApiError } from "../api/errors";
import { type Phrase, t } from "../texts/text";
import type { StopEvent } from "./stopMachine";

/** Between two tries to reach a console that does not answer. */
export const AGAIN_MS = 1000;

const NO_ANSWER: Phrase = "The console did not answer: STOP is sent again until it does.";
const MEANWHILE: Phrase = "If the robot keeps moving, use the emergency button on it.";

/**
 * STOP as a hand presses it: sent again until the console has answered, be it that it cannot, until
 * the robot is seen to be stopped, or until somebody has looked. A page that is left in between
 * goes on: a late STOP does no harm. One that comes after the release would.
 *
 * @param send asks the console for it
 * @param reached the robot tells that it is stopped
 */
export function useStopPress(
  send: () => Promise<{ accepted: boolean; message: string }>,
  dispatch: Dispatch<StopEvent>,
  reached: boolean,
) {
  const newest = useRef(0);
  useEffect(() => {
    if (reached) newest.current += 1;
  }, [reached]);
  const press = useCallback(() => {
    const mine = ++newest.current;
    dispatch({ type: "pressed", now: performance.now() });
    const attempt = () => {
      if (newest.current !== mine) return;
      send().then(
        (answer) => {
          newest.current += 1;
          if (!answer.accepted) dispatch({ type: "refused", problem: answer.message, remedy: "" });
        },
        (error: unknown) => {
          const { status, title, remedy } = asApiError(error);
          if (status !== 0) {
            dispatch({ type: "refused", problem: title, remedy });
          } else if (newest.current === mine) {
            dispatch({ type: "refused", problem: t(NO_ANSWER), remedy: t(MEANWHILE) });
            window.setTimeout(attempt, AGAIN_MS);
          }
        },
      );
    };
    attempt();
  }, [send, dispatch]);
  /** Somebody has looked: it is not sent any more. */
  const giveUp = useCallback(() => {
    newest.current += 1;
    dispatch({ type: "dismissed" });
  }, [dispatch]);
  return { press, giveUp };
}
