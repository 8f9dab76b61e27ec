import { useEffect, useRef, useState } from "react";
import type { Condition, ProbeReading } from "../../api/ruleTypes";
import { JsonSocket } from "../../api/socket";
import { isComplete } from "../model/findings";

const REST_MS = 200;

/**
 * How the robot would judge a condition that is being written, again and again.
 *
 * @returns the newest reading, or null while there is none: nothing complete to ask about, or no
 *   answer yet.
 */
export function useProbe(condition: Condition, clear: Condition | null): ProbeReading | null {
  const [reading, setReading] = useState<ProbeReading | null>(null);
  const socket = useRef<JsonSocket<ProbeReading> | null>(null);
  const wanted = useRef<string | null>(null);
  const asked = JSON.stringify({ condition, clear });
  const complete = isComplete(condition) && (clear === null || isComplete(clear));

  useEffect(() => {
    const own = new JsonSocket<ProbeReading>("/api/rules/probe", setReading, (open) => {
      if (open && wanted.current !== null) own.send(JSON.parse(wanted.current));
      if (!open) setReading(null);
    });
    socket.current = own;
    own.open();
    return () => own.close();
  }, []);

  useEffect(() => {
    setReading(null);
    const timer = window.setTimeout(() => {
      const message = complete ? asked : JSON.stringify({ condition: null });
      wanted.current = message;
      socket.current?.send(JSON.parse(message));
    }, REST_MS);
    return () => window.clearTimeout(timer);
  }, [asked, complete]);

  return complete ? reading : null;
}
