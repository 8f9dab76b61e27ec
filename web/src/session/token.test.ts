import { afterEach, expect, test } from "vitest";
import { tokenFrom } from "./LoginPage";
import { takeToken } from "./token";

afterEach(() => history.replaceState(null, "", "/"));

test("the token leaves the address as it is read", () => {
  history.replaceState(null, "", "/#token=abc-1");
  expect(takeToken()).toBe("abc-1");
  expect(location.hash).toBe("");
  expect(takeToken()).toBeNull();
});

test("a page without a token asks for one", () => {
  expect(takeToken()).toBeNull();
});

test("the whole printed address may be pasted where the token goes", () => {
  expect(tokenFrom(" http://127.0.0.1:8642/#token=abc-1 ")).toBe("abc-1");
  expect(tokenFrom("abc-1")).toBe("abc-1");
});
