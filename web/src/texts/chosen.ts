import { useSyncExternalStore } from "react";
import { readKept, writeKept } from "../kept";

/** A choice that this browser keeps, one for the whole page. */
export interface Chosen<Value extends string> {
  get: () => Value;
  choose: (value: Value) => void;
  /** The choice, for a component that is drawn again when it changes. */
  use: () => Value;
}

/**
 * @param key under which the browser keeps it
 * @param values what may be chosen; anything else that was kept is as if nothing was
 * @param first what holds before somebody has chosen
 */
export function chosen<Value extends string>(
  key: string,
  values: readonly Value[],
  first: () => Value,
): Chosen<Value> {
  const listeners = new Set<() => void>();
  const kept = readKept(key);
  let now = values.find((value) => value === kept) ?? first();
  const get = () => now;
  const subscribe = (listener: () => void) => {
    listeners.add(listener);
    return () => listeners.delete(listener);
  };
  return {
    get,
    choose: (value) => {
      now = value;
      writeKept(key, value);
      for (const listener of listeners) listener();
    },
    use: () => useSyncExternalStore(subscribe, get),
  };
}
