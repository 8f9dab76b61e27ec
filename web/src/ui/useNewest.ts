import { useCallback, useLayoutEffect, useRef } from "react";

/**
 * A function that stays the same and does what the newest `callback` does: for what is drawn again
 * only when its props change. Not to be called while the page is drawn.
 */
export function useNewest<Arguments extends unknown[], Result>(
  callback: (...args: Arguments) => Result,
): (...args: Arguments) => Result {
  const newest = useRef(callback);
  useLayoutEffect(() => {
    newest.current = callback;
  });
  return useCallback((...args: Arguments) => newest.current(...args), []);
}
