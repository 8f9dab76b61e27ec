import { expect, test } from "vitest";
import { forwardedKey, isInMenu, isTyping } from "./keys";

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

test("keys are taken from this console's own scene only", () => {
  const message = (origin: string, data: unknown) => new MessageEvent("message", { origin, data });
  expect(forwardedKey(message(location.origin, { kompass: "key", key: " " }))).toBe(" ");
  expect(forwardedKey(message("https://evil.example", { kompass: "key", key: " " }))).toBeNull();
  expect(forwardedKey(message(location.origin, { kompass: "ready" }))).toBeNull();
  expect(forwardedKey(message(location.origin, null))).toBeNull();
});
