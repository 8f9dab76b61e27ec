import { useEffect, useState } from "react";
import type { RulesLive } from "../../api/ruleTypes";
import { JsonSocket } from "../../api/socket";
import { useConnection } from "../../state/RobotContext";

export interface LiveRules {
  rules: RulesLive | null;
  /** `performance.now()` when it came. */
  receivedAt: number;
  connected: boolean;
  /** Grows with everything that happens in the journal: when to look there again. */
  happened: number;
}

const NOTHING: LiveRules = { rules: null, receivedAt: 0, connected: false, happened: 0 };

/** How the rules are doing, as the robot tells it; newest wins. */
export function useLiveRules(): LiveRules {
  const connection = useConnection();
  const [live, setLive] = useState(NOTHING);
  useEffect(() => {
    // The console must know this browser first; a new connection is also when to try again.
    if (connection === 0) return;
    const socket = new JsonSocket<RulesLive>("/api/rules/live", {
      message: (rules) =>
        setLive((was) => ({
          rules,
          receivedAt: performance.now(),
          connected: true,
          happened: was.happened + rules.firings.length + rules.missed,
        })),
      open: (open) => setLive((was) => ({ ...was, connected: open, happened: was.happened + 1 })),
    });
    socket.open();
    return () => socket.close();
  }, [connection]);
  return live;
}
