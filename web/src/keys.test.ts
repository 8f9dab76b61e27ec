import { renderHook } from "@testing-library/react";
import { afterEach, expect, test, vi } from "vitest";
import { forwardedKey, isInMenu, isTyping, useKeys, useStopKey } from "./keys";

test.each(["text", "password", "number"])("a space in a %s field is text, not STOP", (type) => {
  const input = document.createElement("input");
  input.type = type;
  expect(isTyping(input)).toBe(true);
});

test("a space on a button, a checkbox or the page is STOP", () => {
  const box = document.createElement("input");
  box.type = "checkbox";
  expect(isTyping(box)).toBe(false);
  expect(isTyping(document.createElement("button"))).toBe(false);
  expect(isTyping(document.body)).toBe(false);
});

test("an open menu knows best what a key means, also while its button has the focus", () => {
  const button = document.createElement("button");
  button.setAttribute("aria-haspopup", "menu");
  button.setAttribute("aria-expanded", "false");
  expect(isInMenu(button)).toBe(false);
  button.setAttribute("aria-expanded", "true");
  expect(isInMenu(button)).toBe(true);
  const menu = document.createElement("div");
  menu.setAttribute("role", "menu");
  expect(isInMenu(menu.appendChild(document.createElement("button")))).toBe(true);
  expect(isInMenu(document.body)).toBe(false);
});

test("Escape closes a menu that has opened and has not taken the focus yet", () => {
  const handle = vi.fn(() => true);
  const { unmount } = renderHook(() => useKeys(handle));
  const button = document.createElement("button");
  const pressed = vi.fn();
  button.addEventListener("click", pressed);
  button.setAttribute("aria-haspopup", "menu");
  document.body.append(button);
  const leave = () => {
    button.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape", bubbles: true }));
    return [pressed.mock.calls.length, handle.mock.calls.length];
  };
  button.setAttribute("aria-expanded", "true");
  expect(leave()).toEqual([1, 0]);
  button.setAttribute("aria-expanded", "false");
  expect(leave()).toEqual([1, 1]);
  unmount();
});

test("keys are taken from this console's own scene only", () => {
  const message = (origin: string, data: unknown) => new MessageEvent("message", { origin, data });
  expect(forwardedKey(message(location.origin, { kompass: "key", key: " " }))).toBe(" ");
  expect(forwardedKey(message("https://evil.example", { kompass: "key", key: " " }))).toBeNull();
  expect(forwardedKey(message(location.origin, { kompass: "ready" }))).toBeNull();
  expect(forwardedKey(message(location.origin, null))).toBeNull();
});

afterEach(() => document.body.replaceChildren());

/** Presses the space bar on an element; how often STOP was pressed, and what the page saw of it. */
function spaceOn(element: HTMLElement, modifiers: KeyboardEventInit = {}) {
  const press = vi.fn();
  const seen = vi.fn();
  const { unmount } = renderHook(() => useStopKey(press));
  document.body.append(element);
  element.addEventListener("keydown", seen);
  const event = new KeyboardEvent("keydown", {
    key: " ",
    code: "Space",
    bubbles: true,
    cancelable: true,
    ...modifiers,
  });
  element.dispatchEvent(event);
  unmount();
  return {
    stops: press.mock.calls.length,
    typed: !event.defaultPrevented,
    seen: seen.mock.calls.length,
  };
}

const input = (attributes: { type: string; readOnly?: boolean; role?: string }) =>
  Object.assign(document.createElement("input"), attributes);

test.each<[string, HTMLElement]>([
  ["a list that is only chosen from", input({ type: "text", readOnly: true })],
  ["a native select", document.createElement("select")],
  ["a button", document.createElement("button")],
  ["a checkbox", input({ type: "checkbox" })],
  ["the page", document.createElement("main")],
])("a space on %s stops, and does nothing else", (_, element) => {
  expect(spaceOn(element)).toEqual({ stops: 1, typed: false, seen: 0 });
});

test.each<[string, HTMLElement]>([
  ["a text field", input({ type: "text" })],
  ["a list that is searched by typing", input({ type: "text", role: "combobox" })],
  ["a long text", document.createElement("textarea")],
])("a space in %s is a blank, and with Ctrl it stops", (_, element) => {
  expect(spaceOn(element)).toEqual({ stops: 0, typed: true, seen: 1 });
  expect(spaceOn(element, { ctrlKey: true })).toEqual({ stops: 1, typed: false, seen: 0 });
  expect(spaceOn(element, { metaKey: true }).stops).toBe(1);
  expect(spaceOn(element, { ctrlKey: true, altKey: true }).stops).toBe(0);
});

test("a space bar that is held stops once", () => {
  expect(spaceOn(document.createElement("button"), { repeat: true })).toEqual({
    stops: 0,
    typed: false,
    seen: 0,
  });
});

/** Whether a letter that is pressed on an element is a shortcut of the page. */
function letterOn(element: HTMLElement): boolean {
  const handle = vi.fn(() => true);
  const { unmount } = renderHook(() => useKeys(handle));
  document.body.append(element);
  element.dispatchEvent(new KeyboardEvent("keydown", { key: "g", bubbles: true }));
  unmount();
  return handle.mock.calls.length > 0;
}

test.each<[string, HTMLElement]>([
  ["a list that is only chosen from", input({ type: "text", readOnly: true, role: "combobox" })],
  ["a list that is searched by typing", input({ type: "text", role: "combobox" })],
  ["a native select", document.createElement("select")],
])("a letter on %s finds an entry, and is no shortcut", (_, element) => {
  expect(letterOn(element)).toBe(false);
});

test("a letter on a button is a shortcut", () => {
  expect(letterOn(document.createElement("button"))).toBe(true);
});
