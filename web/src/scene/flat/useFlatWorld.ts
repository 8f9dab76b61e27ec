import { useEffect, useState } from "react";
import { JsonSocket } from "../../api/socket";
import type { FlatNews } from "../../api/types";
import { type FlatWorld, NOTHING, told } from "./world";

/** The console has something to say every 2 s. */
const SILENCE_MS = 6000;

/** What there is to draw, for as long as somebody draws it; `live` while it is kept up to date. */
export function useFlatWorld(view: string | null): { world: FlatWorld; live: boolean } {
  const [world, setWorld] = useState(NOTHING);
  const [live, setLive] = useState(false);
  useEffect(() => {
    // Every connection begins with all there is: what was there before is drawn until then.
    let fresh = false;
    const socket = new JsonSocket<FlatNews>(
      `/api/map/live?view=${encodeURIComponent(view ?? "")}`,
      {
        open: (open) => {
          fresh = open;
          if (!open) setLive(false);
        },
        message: (news) => {
          const from = fresh ? NOTHING : null;
          fresh = false;
          setWorld((was) => told(from ?? was, news));
          setLive(true);
        },
        silenceMs: SILENCE_MS,
      },
    );
    socket.open();
    return () => socket.close();
  }, [view]);
  return { world, live };
}
