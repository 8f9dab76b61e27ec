import {
  createContext,
  type ReactNode,
  useCallback,
  useContext,
  useEffect,
  useMemo,
  useRef,
  useState,
} from "react";
import { leaveDrive, playDrive } from "../api/client";
import { type ApiError, asApiError } from "../api/errors";
import type { PlayedDrive } from "../api/types";

export interface Stage {
  /** Whether a drive can be played in the scene: it is there, to be seen, and draws. */
  ready: boolean;
  /** Why the scene did not take the last drive. */
  error: ApiError | null;
  /** The drive that the scene shows in the place of the robot. */
  shown: Pick<PlayedDrive, "drill" | "scenario"> | null;
  /** Plays a drive in the scene, from a moment of it on at a speed. */
  show: (played: PlayedDrive) => void;
  /** Shows the robot again. */
  leave: () => void;
}

const StageContext = createContext<Stage | null>(null);

/** The console lets the robot come back when it is not told of the drive for 10 s. */
const AGAIN_MS = 2000;
const FORGOTTEN_MS = 11_000;

interface Props {
  /** Id of this page's scene. */
  view: string | null;
  ready: boolean;
  children: ReactNode;
}

/** What the scene shows: the robot, or a drive of a drill in its place. On this page only. */
export function StageProvider({ view, ready, children }: Props) {
  const [shown, setShown] = useState<Stage["shown"]>(null);
  const [error, setError] = useState<ApiError | null>(null);
  // One request at a time, each with what is newest by then: a dragged head never queues up.
  const wanted = useRef<PlayedDrive | null>(null);
  const told = useRef<PlayedDrive | null>(null);
  const telling = useRef(false);
  const since = useRef(0);

  const tell = useCallback(async (of: string) => {
    if (telling.current) return;
    telling.current = true;
    try {
      while (told.current !== wanted.current) {
        const next = wanted.current;
        await (next === null ? leaveDrive(of) : playDrive(of, next));
        told.current = next;
        setError(null);
        setShown((was) => (isSame(was, next) ? was : next));
      }
    } catch (failure) {
      setError(asApiError(failure));
      // Until the console has forgotten the drive, the scene may show it: so the page says.
      if (told.current === null) setShown(null);
      else window.setTimeout(() => wanted.current === null && setShown(null), FORGOTTEN_MS);
      wanted.current = told.current = null;
    } finally {
      telling.current = false;
    }
  }, []);

  const show = useCallback(
    (played: PlayedDrive) => {
      if (view === null || !ready) return;
      wanted.current = played;
      since.current = performance.now();
      void tell(view);
    },
    [view, ready, tell],
  );
  const leave = useCallback(() => {
    if (view === null || wanted.current === null) return;
    wanted.current = null;
    void tell(view);
  }, [view, tell]);

  useEffect(() => {
    if (!ready) leave();
  }, [ready, leave]);
  useEffect(() => {
    if (view === null || shown === null) return;
    const timer = window.setInterval(() => {
      const before = wanted.current;
      if (before === null) return;
      const now = performance.now();
      const moment = before.moment + (before.speed * (now - since.current)) / 1000;
      since.current = now;
      wanted.current = { ...before, moment };
      void tell(view);
    }, AGAIN_MS);
    return () => window.clearInterval(timer);
  }, [view, shown, tell]);

  const stage = useMemo<Stage>(
    () => ({ ready: ready && view !== null, error, shown, show, leave }),
    [ready, view, error, shown, show, leave],
  );
  return <StageContext value={stage}>{children}</StageContext>;
}

const isSame = (one: Stage["shown"], other: Stage["shown"]) =>
  one?.drill === other?.drill && one?.scenario === other?.scenario;

export function useStage(): Stage {
  const stage = useContext(StageContext);
  if (stage === null) throw new Error("useStage needs a StageProvider above it");
  return stage;
}
