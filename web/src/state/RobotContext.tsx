import {
  createContext,
  type ReactNode,
  useContext,
  useEffect,
  useMemo,
  useState,
  useSyncExternalStore,
} from "react";
import type { State } from "../api/types";
import { type Cause, rootCause } from "./causes";
import { RobotLink } from "./link";
import { FROZEN_S } from "./overall";

/** The newest snapshot and how old it is on this page's clock. */
export interface Robot {
  state: State | null;
  /** Seconds since the snapshot came (since the page opened, when none has come). */
  elapsed: number;
  frozen: boolean;
  connected: boolean;
  version: string | null;
  /** What is behind all that is wrong with the robot; null while nothing is. */
  cause: Cause | null;
}

const RobotContext = createContext<Robot | null>(null);
const ConnectionContext = createContext(0);

/** Ages go on counting while nothing arrives, so they need a clock of their own. */
const TICK_MS = 250;

export function RobotProvider(props: { onRefused: () => void; children: ReactNode }) {
  const { onRefused, children } = props;
  const link = useMemo(() => new RobotLink(onRefused), [onRefused]);
  useEffect(() => {
    link.open();
    return () => link.close();
  }, [link]);
  const snapshot = useSyncExternalStore(link.subscribe, link.getSnapshot);
  const [opened] = useState(() => performance.now());
  const tick = useTick(snapshot);

  const robot = useMemo<Robot>(() => {
    const now = Math.max(tick, performance.now());
    const elapsed = Math.max(0, now - (snapshot.receivedAt ?? opened)) / 1000;
    return {
      state: snapshot.state,
      elapsed,
      frozen: elapsed > FROZEN_S,
      connected: snapshot.connected,
      version: snapshot.version,
      cause: rootCause(snapshot.state, elapsed),
    };
  }, [snapshot, tick, opened]);
  return (
    <ConnectionContext value={snapshot.connection}>
      <RobotContext value={robot}>{children}</RobotContext>
    </ConnectionContext>
  );
}

/** Counts the connections to the console (0: none yet), without a render per snapshot. */
export function useConnection(): number {
  return useContext(ConnectionContext);
}

/** Re-renders its component at every snapshot: leaves only, never around the scene. */
export function useRobot(): Robot {
  const robot = useContext(RobotContext);
  if (robot === null) throw new Error("useRobot needs a RobotProvider above it");
  return robot;
}

/** The robot's own clock, in seconds since the epoch; this browser's may be wrong. */
export function useNow(): number {
  const { state, elapsed } = useRobot();
  return state === null ? Date.now() / 1000 : state.time + elapsed;
}

/** Ticks while nothing arrives: each snapshot is a look at the clock already. */
function useTick(snapshot: unknown): number {
  const [now, setNow] = useState(() => performance.now());
  // biome-ignore lint/correctness/useExhaustiveDependencies: a snapshot begins the wait anew
  useEffect(() => {
    const timer = window.setInterval(() => setNow(performance.now()), TICK_MS);
    return () => window.clearInterval(timer);
  }, [snapshot]);
  return now;
}
