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

/**
 * True where the space bar writes a blank. A list that is only chosen from looks like a text field
 * to the browser, and is none.
 */
export function takesBlank(target: EventTarget | null): boolean {
  if (!(target instanceof HTMLElement)) return false;
  if (target instanceof HTMLInputElement || target instanceof HTMLTextAreaElement) {
    return isTyping(target) && !target.readOnly && !target.disabled;
  }
  return target.isContentEditable;
}

/** A blank that is not text is STOP; with Ctrl (or Cmd) it never is text. */
export function isStopKey(event: KeyboardEvent): boolean {
  if (event.key !== " " && event.code !== "Space") return false;
  // AltGr is Ctrl and Alt on some keyboards, and types a blank of its own.
  return ((event.ctrlKey || event.metaKey) && !event.altKey) || !takesBlank(event.target);
}

/** True in an open menu or list, and on its button: that has the focus until the menu takes it. */
export function isInMenu(target: EventTarget | null): boolean {
  return target instanceof Element && target.closest(MENU) !== null;
}

/** The button whose menu is open while it still has the focus itself, or null. */
function menuButton(target: EventTarget | null): HTMLElement | null {
  if (!(target instanceof Element)) return null;
  return target.closest<HTMLElement>("[aria-haspopup=menu][aria-expanded=true]");
}

/** A key of the scene's frame that drives by hand, or null for any other message. */
export function forwardedHand(
  event: MessageEvent<unknown>,
): { code: string; down: boolean } | "left" | null {
  if (event.origin !== location.origin) return null;
  const data = event.data;
  if (typeof data !== "object" || data === null) return null;
  const { kompass, code, down } = data as Record<string, unknown>;
  if (kompass === "left") return "left";
  if (kompass !== "hand" || typeof code !== "string" || typeof down !== "boolean") return null;
  return { code, down };
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
 * Calls `handle` for every key outside text fields but STOP's, wherever the focus is, the scene's
 * frame included. `handle` returns true when it used the key; the browser then does nothing with it.
 */
export function useKeys(handle: (press: KeyPress) => boolean): void {
  const latest = useRef(handle);
  useEffect(() => {
    latest.current = handle;
  });
  useEffect(() => {
    const onKeyDown = (event: KeyboardEvent) => {
      if (event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target)) return;
      if (event.repeat || isStopKey(event)) return;
      // A menu hears Escape only when it has taken the focus, a moment after it has opened.
      const opener = event.key === "Escape" ? menuButton(event.target) : null;
      if (opener !== null) {
        event.preventDefault();
        opener.click();
        return;
      }
      const onControl =
        event.target instanceof Element &&
        event.target.closest("button, a, [role=menuitemcheckbox]") !== null;
      const inMenu = isInMenu(event.target);
      if (latest.current({ key: event.key, onControl, inMenu })) event.preventDefault();
    };
    const onMessage = (event: MessageEvent<unknown>) => {
      const key = forwardedKey(event);
      if (key !== null) latest.current({ key, onControl: false, inMenu: false });
    };
    // Capture: a menu that keeps its keys to itself must not keep them from the page.
    window.addEventListener("keydown", onKeyDown, true);
    window.addEventListener("message", onMessage);
    return () => {
      window.removeEventListener("keydown", onKeyDown, true);
      window.removeEventListener("message", onMessage);
    };
  }, []);
}

/** Calls `press` for the key of STOP, wherever the focus is; the key then does nothing else. */
export function useStopKey(press: () => void): void {
  useEffect(() => {
    // Capture: a menu that keeps its keys to itself must not keep STOP from the robot, and the key
    // that stops must not open a list besides.
    const onKeyDown = (event: KeyboardEvent) => {
      if (!isStopKey(event)) return;
      event.preventDefault();
      event.stopPropagation();
      if (!event.repeat) press();
    };
    // Some browsers press a focused button when the space bar is let go.
    const onKeyUp = (event: KeyboardEvent) => {
      if (isStopKey(event)) event.preventDefault();
    };
    const onMessage = (event: MessageEvent<unknown>) => {
      if (forwardedKey(event) === " ") press();
    };
    window.addEventListener("keydown", onKeyDown, true);
    window.addEventListener("keyup", onKeyUp, true);
    window.addEventListener("message", onMessage);
    return () => {
      window.removeEventListener("keydown", onKeyDown, true);
      window.removeEventListener("keyup", onKeyUp, true);
      window.removeEventListener("message", onMessage);
    };
  }, [press]);
}
