import { createContext, type ReactNode, useContext, useMemo, useState } from "react";
import type { Firing } from "../../api/ruleTypes";

/** Which page of the rules is looked at. */
export type Place =
  | { at: "table" }
  | { at: "edit"; id: string }
  | { at: "why"; id: string; firing: Firing | null }
  | { at: "review" }
  | { at: "conflict" }
  | { at: "firings"; rule: string | null }
  | { at: "history"; revision: number | null }
  | { at: "recordings"; name: string | null };

interface Nav {
  open: boolean;
  place: Place;
  /** Opens the rules there. */
  go: (place: Place) => void;
  /** To where one came from. */
  back: () => void;
  close: () => void;
  toggle: () => void;
}

const NavContext = createContext<Nav | null>(null);
const TABLE: Place = { at: "table" };
const TABS: ReadonlySet<Place["at"]> = new Set(["table", "firings", "history", "recordings"]);

export function RulesNavProvider({ children }: { children: ReactNode }) {
  const [open, setOpen] = useState(false);
  const [trail, setTrail] = useState<Place[]>([TABLE]);
  const nav = useMemo<Nav>(
    () => ({
      open,
      place: trail.at(-1) ?? TABLE,
      go: (place) => {
        // A tab is where a way begins; the same page again takes the place of itself.
        setTrail((was) =>
          TABS.has(place.at)
            ? [place]
            : [...(was.at(-1)?.at === place.at ? was.slice(0, -1) : was), place].slice(-8),
        );
        setOpen(true);
      },
      back: () => setTrail((was) => (was.length > 1 ? was.slice(0, -1) : [TABLE])),
      close: () => setOpen(false),
      toggle: () => setOpen((was) => !was),
    }),
    [open, trail],
  );
  return <NavContext value={nav}>{children}</NavContext>;
}

export function useNav(): Nav {
  const nav = useContext(NavContext);
  if (nav === null) throw new Error("useNav needs a RulesNavProvider above it");
  return nav;
}
