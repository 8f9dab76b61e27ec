import { createContext, type ReactNode, useContext, useEffect, useRef, useState } from "react";
import type { State } from "../api/types";
import { useSession } from "../session/SessionContext";
import { useRobot } from "../state/RobotContext";
import { type Notice, noticesBetween } from "./notices";
import { isQuiet, keepSettings, type NotifySettings, readSettings } from "./settings";
import { play } from "./sound";

interface Notify {
  settings: NotifySettings;
  change: (part: Partial<NotifySettings>) => void;
}

const NotifyContext = createContext<Notify | null>(null);

/** Tells whoever does not look at the page what happens to the robot, as this browser is told to. */
export function NotifyProvider({ children }: { children: ReactNode }) {
  const [settings, setSettings] = useState(readSettings);
  const change = (part: Partial<NotifySettings>) => {
    const changed = { ...settings, ...part };
    keepSettings(changed);
    setSettings(changed);
  };
  return (
    <NotifyContext value={{ settings, change }}>
      <Notifier settings={settings} />
      {children}
    </NotifyContext>
  );
}

export function useNotify(): Notify {
  const value = useContext(NotifyContext);
  if (value === null) throw new Error("useNotify needs a NotifyProvider above it");
  return value;
}

function Notifier({ settings }: { settings: NotifySettings }) {
  const { state, frozen, elapsed } = useRobot();
  const { session } = useSession();
  const last = useRef<State | null>(null);
  useEffect(() => {
    // After a gap everything that happened in it is news, and told once.
    if (state === null || frozen) return;
    const before = last.current;
    last.current = state;
    if (before === null || before === state || isQuiet(settings, new Date())) return;
    tell(noticesBetween(before, state, session), state.robot.name, settings);
  }, [state, frozen, session, settings]);
  const lost = state !== null && elapsed > LOST_S;
  const name = state?.robot.name ?? "";
  useEffect(() => {
    if (lost && !isQuiet(settings, new Date())) tell([LOST], name, settings);
  }, [lost, name, settings]);
  return null;
}

const LOST_S = 15; // a network that hiccups is nobody's business
const LOST: Notice = {
  tag: "link",
  title: "Nothing is heard of the robot",
  body: "Look at the network, and whether its program runs.",
  urgent: true,
};

function tell(notices: Notice[], robot: string, settings: NotifySettings): void {
  if (notices.length === 0) return;
  if (settings.sound) play(notices.some(({ urgent }) => urgent));
  if (!settings.message || !document.hidden) return;
  for (const { tag, title, body } of notices) {
    const told = new Notification(`${robot}: ${title}`, { body, tag });
    told.onclick = () => window.focus();
  }
}
