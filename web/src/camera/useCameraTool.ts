import { useCallback, useMemo, useState } from "react";

export interface CameraTool {
  open: boolean;
  large: boolean;
  toggle: () => void;
  resize: () => void;
  /** One step back: smaller, then closed. False when there was nothing to go back from. */
  back: () => boolean;
}

/** Whether a camera is looked at, and how large. Closed when the page opens: nobody pays unasked. */
export function useCameraTool(): CameraTool {
  const [open, setOpen] = useState(false);
  const [large, setLarge] = useState(false);
  const toggle = useCallback(() => {
    setLarge(false);
    setOpen((was) => !was);
  }, []);
  const resize = useCallback(() => setLarge((was) => !was), []);
  const back = useCallback(() => {
    if (!open) return false;
    if (large) setLarge(false);
    else setOpen(false);
    return true;
  }, [open, large]);
  return useMemo(
    () => ({ open, large, toggle, resize, back }),
    [open, large, toggle, resize, back],
  );
}
