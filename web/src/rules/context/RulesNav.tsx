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
  | { at: "timeline" }
  | { at: "log" }
  | { at: "recordings"; name: string | null }
  | { at: "audit" };

interface Nav {
  open: boolean;
  place: Place;
  /** Id of the element from which one went on, once one is back; the keyboard goes on there. */
  returnTo: string;
  /** Opens the rules there. */
  go: (place: Place) => void;
  /** To where one came from; false when that was nowhere. */
  back: () => boolean;
  close: () => void;
  toggle: () => void;
}

const NavContext = createContext<Nav | null>(null);
/** Ids of the buttons that open the rules; which of them is shown depends on the screen. */
export const OPENERS = { rail: "open-rules", tab: "open-rules-tab" };
export const SHEET_ID = "rules-sheet";

interface Step {
  place: Place;
  /** Id of what had the focus when one went there. */
  from: string;
}

const BEGIN: Step = { place: { at: "table" }, from: "" };
const TABS: ReadonlySet<Place["at"]> = new Set([
  "table",
  "firings",
  "timeline",
  "log",
  "history",
  "recordings",
  "audit",
]);

export function RulesNavProvider({ children }: { children: ReactNode }) {
  const [open, setOpen] = useState(false);
  const [trail, setTrail] = useState<Step[]>([BEGIN]);
  const [returnTo, setReturnTo] = useState("");
  const nav = useMemo<Nav>(
    () => ({
      open,
      place: (trail.at(-1) ?? BEGIN).place,
      returnTo,
      go: (place) => {
        const step = { place, from: document.activeElement?.id ?? "" };
        const again = trail.findIndex((each) => each.place.at === place.at);
        setReturnTo(again < 0 ? "" : (trail[again + 1]?.from ?? ""));
        // A tab is where a way begins; the same page again takes the place of itself.
        setTrail(
          TABS.has(place.at)
            ? [step]
            : [...(trail.at(-1)?.place.at === place.at ? trail.slice(0, -1) : trail), step].slice(
                -8,
              ),
        );
        setOpen(true);
      },
      back: () => {
        setReturnTo(trail.at(-1)?.from ?? "");
        setTrail(trail.length > 1 ? trail.slice(0, -1) : [BEGIN]);
        return trail.length > 1;
      },
      close: () => {
        setOpen(false);
        const inside = document.activeElement?.closest(`#${SHEET_ID}`);
        if (inside === null || inside === undefined) return;
        // Whoever closed them from within goes on where they were opened; one of the two is hidden.
        for (const id of Object.values(OPENERS)) document.getElementById(id)?.focus();
      },
      toggle: () => setOpen((was) => !was),
    }),
    [open, trail, returnTo],
  );
  return <NavContext value={nav}>{children}</NavContext>;
}

export function useNav(): Nav {
  const nav = useContext(NavContext);
  if (nav === null) throw new Error("useNav needs a RulesNavProvider above it");
  return nav;
}
