import { createContext, type ReactNode, useContext, useEffect, useMemo, useReducer } from "react";
import { stopRobot } from "../api/client";
import type { Drive } from "../api/types";
import { useStopKey } from "../keys";
import { FROZEN_S } from "../state/overall";
import { useRobot } from "../state/RobotContext";
import { IDLE, type StopState, stopReducer } from "./stopMachine";
import { useStopPress } from "./useStopPress";

interface Stop {
  stop: StopState;
  /** The drive manager's newest report, or null when it is too old to believe. */
  drive: Drive | null;
  press: () => void;
  dismiss: () => void;
}

const StopContext = createContext<Stop | null>(null);

export function StopProvider({ children }: { children: ReactNode }) {
  const { state, elapsed } = useRobot();
  const [stop, dispatch] = useReducer(stopReducer, IDLE);
  const reported = state?.drive ?? null;
  const drive =
    reported?.available && reported.age + elapsed <= FROZEN_S && elapsed <= FROZEN_S
      ? reported
      : null;

  // `elapsed` runs on while nothing arrives: it is what makes an unanswered stop time out.
  // biome-ignore lint/correctness/useExhaustiveDependencies: elapsed is the clock of this effect
  useEffect(() => {
    const event = { type: "observed", drive, now: performance.now() } as const;
    // Most often it changes nothing, and a dispatch draws all that shows STOP once more.
    if (stopReducer(stop, event) !== stop) dispatch(event);
  }, [drive, elapsed, stop]);

  const { press, giveUp: dismiss } = useStopPress(stopRobot, dispatch, stop.latched);

  useStopKey(press);

  const value = useMemo(() => ({ stop, drive, press, dismiss }), [stop, drive, press, dismiss]);
  return <StopContext value={value}>{children}</StopContext>;
}

export function useStop(): Stop {
  const stop = useContext(StopContext);
  if (stop === null) throw new Error("useStop needs a StopProvider above it");
  return stop;
}
