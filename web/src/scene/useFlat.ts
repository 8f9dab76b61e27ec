import { useCallback, useMemo, useState } from "react";
import { readKept, writeKept } from "../kept";
import { drawsWebGl } from "./webgl";

const KEY = "kompass.scene";

export interface Flat {
  /** The map is drawn flat, by the page. */
  flat: boolean;
  /** There is a choice: this browser draws in three dimensions, too. */
  choice: boolean;
  toggle: () => void;
}

/** Whether the map is drawn flat: where nothing else is possible, or where somebody chose it. */
export function useFlat(): Flat {
  const choice = drawsWebGl();
  const [chosen, setChosen] = useState(() => readKept(KEY) === "flat");
  const toggle = useCallback(() => {
    setChosen(!chosen);
    writeKept(KEY, chosen ? "3d" : "flat");
  }, [chosen]);
  const flat = chosen || !choice;
  return useMemo(() => ({ flat, choice, toggle }), [flat, choice, toggle]);
}
