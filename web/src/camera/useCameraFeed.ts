import { useEffect, useState } from "react";
import { JsonSocket } from "../api/socket";
import type { CameraNews } from "../api/types";

/** The console has something to say every second, and of a picture that we have not seen in ten. */
const SILENCE_MS = 15_000;
const TICK_MS = 250;

export interface CameraFeed {
  /** The newest picture as a data URL; empty before the first one. */
  picture: string;
  width: number;
  height: number;
  /** Of the newest picture by now, s; null before the first one. */
  age: number | null;
  /** Since this camera is looked at, s. */
  waited: number;
  problem: string;
}

interface Heard extends Pick<CameraFeed, "picture" | "width" | "height" | "problem"> {
  age: number | null;
  at: number;
}

const NOTHING: Heard = { picture: "", width: 0, height: 0, age: null, problem: "", at: 0 };

/** What a camera shows, for as long as somebody can see it: a page in the background asks for none. */
export function useCameraFeed(topic: string | null, large: boolean, seen: boolean): CameraFeed {
  const [heard, setHeard] = useState(NOTHING);
  const [since, setSince] = useState(() => performance.now());
  const [now, setNow] = useState(since);
  const visible = usePageVisible() && seen;
  // biome-ignore lint/correctness/useExhaustiveDependencies: what another camera showed is not shown
  useEffect(() => {
    setHeard(NOTHING);
    setSince(performance.now());
  }, [topic]);
  useEffect(() => {
    if (topic === null || !visible) return;
    const asked = new URLSearchParams({ topic, size: large ? "large" : "small" });
    const socket = new JsonSocket<CameraNews>(`/api/camera?${asked}`, {
      message: (news) => {
        // So the next one is sent: there is never more than one on its way.
        if (news.picture !== "") socket.send({ seen: news.number });
        setHeard((was) => heardNow(was, news));
      },
      silenceMs: SILENCE_MS,
    });
    socket.open();
    return () => socket.close();
  }, [topic, large, visible]);
  useEffect(() => {
    const timer = window.setInterval(() => setNow(performance.now()), TICK_MS);
    return () => window.clearInterval(timer);
  }, []);
  const { picture, width, height, age, problem, at } = heard;
  const passed = Math.max(0, now - at) / 1000;
  const waited = Math.max(0, now - since) / 1000;
  return { picture, width, height, problem, age: age === null ? null : age + passed, waited };
}

function heardNow(was: Heard, news: CameraNews): Heard {
  const { picture, width, height, age, problem } = news;
  const at = performance.now();
  if (picture !== "") return { picture, width, height, age, problem: "", at };
  // A new connection has no picture yet; the one that is shown goes on growing older.
  if (age === null) return { ...was, problem };
  return { ...was, age, problem, at };
}

function usePageVisible(): boolean {
  const [visible, setVisible] = useState(!document.hidden);
  useEffect(() => {
    const onChange = () => setVisible(!document.hidden);
    document.addEventListener("visibilitychange", onChange);
    return () => document.removeEventListener("visibilitychange", onChange);
  }, []);
  return visible;
}
