import { useEffect, useRef } from "react";

/** A key pressed in the page or in the scene's frame. */
export interface KeyPress {
  key: string;
  /** A button has the focus. */
  onControl: boolean;
  /** Something lies open over the page that knows best what Escape means: a menu, a list. */
  inMenu: boolean;
}

const MENU = "[role=menu],[role=listbox],[aria-haspopup][aria-expanded=true]";
const TEXT_INPUTS = new Set(["text", "search", "url", "tel", "email", "password", "number"]);

/** True where a key is text: there a space is a space, and not STOP. */
export function isTyping(target: EventTarget | null): boolean {
  if (!(target instanceof HTMLElement)) return false;
  if (target instanceof HTMLInputElement) return TEXT_INPUTS.has(target.type);
  return target instanceof HTMLTextAreaElement || target instanceof HTMLSelectElement;
}

/** True in an open menu or list, and on its button: that has the focus until the menu takes it. */
export function isInMenu(target: EventTarget | null): boolean {
  return target instanceof Element && target.closest(MENU) !== null;
}

/** The key that the scene's frame passed on, or null for any other message. */
export function forwardedKey(event: MessageEvent<unknown>): string | null {
  if (event.origin !== location.origin) return null;
  const data = event.data;
  if (typeof data !== "object" || data === null) return null;
  const { kompass, key } = data as Record<string, unknown>;
  return kompass === "key" && typeof key === "string" ? key : null;
}

/**
 * Calls `handle` for every key outside text fields, wherever the focus is, the scene's frame
 * included. `handle` returns true when it used the key; the browser then does nothing with it.
 */
export function useKeys(handle: (press: KeyPress) => boolean): void {
  const latest = useRef(handle);
  useEffect(() => {
    latest.current = handle;
  });
  useEffect(() => {
    const onKeyDown = (event: KeyboardEvent) => {
      if (event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target)) return;
      if (event.repeat) {
        if (event.key === " ") event.preventDefault();
        return;
      }
      const onControl =
        event.target instanceof Element &&
        event.target.closest("button, a, [role=menuitemcheckbox]") !== null;
      const inMenu = isInMenu(event.target);
      if (latest.current({ key: event.key, onControl, inMenu })) event.preventDefault();
    };
    // Some browsers press a focused button when the space bar is let go.
    const onKeyUp = (event: KeyboardEvent) => {
      if (event.key === " " && !isTyping(event.target)) event.preventDefault();
    };
    const onMessage = (event: MessageEvent<unknown>) => {
      const key = forwardedKey(event);
      if (key !== null) latest.current({ key, onControl: false, inMenu: false });
    };
    // Capture: a menu that keeps its keys to itself must not keep STOP from the robot.
    window.addEventListener("keydown", onKeyDown, true);
    window.addEventListener("keyup", onKeyUp, true);
    window.addEventListener("message", onMessage);
    return () => {
      window.removeEventListener("keydown", onKeyDown, true);
      window.removeEventListener("keyup", onKeyUp, true);
      window.removeEventListener("message", onMessage);
    };
  }, []);
}
