import {
  createContext,
  type ReactNode,
  useCallback,
  useContext,
  useEffect,
  useMemo,
  useRef,
  useState,
  useSyncExternalStore,
} from "react";
import { readKept, writeKept } from "../kept";
import { forwardedHand, isTyping } from "../keys";
import { useSession } from "../session/SessionContext";
import { HandLink, type HandState } from "./handLink";
import { HandLoop } from "./handLoop";
import { isDrivingKey, padPush, twistOf } from "./push";

export interface Hand extends HandState {
  /** The panel is there, and with it the connection on which the wheel is held. */
  open: boolean;
  toggle: () => void;
  close: () => void;
  take: (over: boolean) => void;
  give: () => void;
  ask: () => void;
  loop: HandLoop;
  /** Share of what the robot can do, from 0 to 1. */
  share: number;
  setShare: (share: number) => void;
}

const HandContext = createContext<Hand | null>(null);

export const LEAST_SHARE = 0.1;
const FIRST_SHARE = 0.5;

export function HandProvider({ children }: { children: ReactNode }) {
  const { session } = useSession();
  const [open, setOpen] = useState(false);
  const link = useMemo(() => new HandLink(), []);
  const state = useSyncExternalStore(link.subscribe, link.getSnapshot);
  const { yours } = state;
  const [share, setShare] = useKept(`kompass-hand-speed:${session.user}`, FIRST_SHARE);
  const speed = useRef(share);
  useEffect(() => {
    speed.current = share;
  }, [share]);
  const loop = useMemo(
    () =>
      new HandLoop(
        (push) => link.drive(twistOf(push, link.getSnapshot().limits, speed.current)),
        () => padPush(navigator.getGamepads?.() ?? []),
      ),
    [link],
  );

  useEffect(() => {
    if (!open) return;
    link.open();
    return () => link.close();
  }, [open, link]);
  useEffect(() => (yours ? atTheWheel(loop) : undefined), [yours, loop]);

  const toggle = useCallback(() => setOpen((was) => !was), []);
  const close = useCallback(() => setOpen(false), []);
  const take = useCallback((over: boolean) => link.take(over), [link]);
  const give = useCallback(() => {
    loop.letGo();
    link.give();
  }, [link, loop]);
  const ask = useCallback(() => link.ask(), [link]);

  const value = useMemo(
    () => ({ ...state, open, toggle, close, take, give, ask, loop, share, setShare }),
    [state, open, toggle, close, take, give, ask, loop, share, setShare],
  );
  return <HandContext value={value}>{children}</HandContext>;
}

export function useHand(): Hand {
  const hand = useContext(HandContext);
  if (hand === null) throw new Error("useHand needs a HandProvider above it");
  return hand;
}

/** Keys and focus belong to the wheel for as long as the page has it. */
function atTheWheel(loop: HandLoop): () => void {
  const onKey = (event: KeyboardEvent) => {
    if (event.type === "keyup") {
      loop.key(event.code, false);
      return;
    }
    if (event.ctrlKey || event.metaKey || event.altKey) {
      // A command of the browser's or the system's, which may swallow the end of what is held.
      loop.letGo();
      return;
    }
    if (takesArrows(event.target) || !isDrivingKey(event.code)) return;
    event.preventDefault();
    if (!event.repeat) loop.key(event.code, true);
  };
  const onMessage = (event: MessageEvent<unknown>) => {
    const hand = forwardedHand(event);
    if (hand === "left") loop.letGoKeys();
    else if (hand !== null) loop.key(hand.code, hand.down);
  };
  const letGo = () => loop.letGo();
  const onBlur = () => {
    // A second finger that turns the scene takes the focus there, and the thumb is still on the stick.
    if (document.activeElement instanceof HTMLIFrameElement) loop.letGoKeys();
    else loop.letGo();
  };
  const onVisibility = () => {
    if (document.hidden) loop.letGo();
  };
  // The scene's frame asks the page that it is in whether its keys drive.
  document.documentElement.dataset.hand = "";
  window.addEventListener("keydown", onKey, true);
  window.addEventListener("keyup", onKey, true);
  window.addEventListener("message", onMessage);
  window.addEventListener("blur", onBlur);
  window.addEventListener("pagehide", letGo);
  document.addEventListener("visibilitychange", onVisibility);
  loop.start();
  return () => {
    loop.stop();
    delete document.documentElement.dataset.hand;
    window.removeEventListener("keydown", onKey, true);
    window.removeEventListener("keyup", onKey, true);
    window.removeEventListener("message", onMessage);
    window.removeEventListener("blur", onBlur);
    window.removeEventListener("pagehide", letGo);
    document.removeEventListener("visibilitychange", onVisibility);
  };
}

/** Where letters are text, or arrows choose. */
function takesArrows(target: EventTarget | null): boolean {
  if (isTyping(target)) return true;
  return (
    target instanceof Element && target.closest("[role=slider],[role=menu],[role=listbox]") !== null
  );
}

/** A number from 0 to 1 that this browser keeps. */
function useKept(key: string, first: number): [number, (value: number) => void] {
  const [value, setValue] = useState(() => {
    const kept = Number.parseFloat(readKept(key) ?? "");
    return kept >= LEAST_SHARE && kept <= 1 ? kept : first;
  });
  const keep = useCallback(
    (next: number) => {
      setValue(next);
      writeKept(key, String(next));
    },
    [key],
  );
  return [value, keep];
}
