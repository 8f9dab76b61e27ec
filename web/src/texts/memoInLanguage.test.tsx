import { act, cleanup, render, screen } from "@testing-library/react";
import { afterEach, expect, test } from "vitest";
import { language } from "./language";
import { memoInLanguage } from "./memoInLanguage";
import { t } from "./text";

afterEach(() => {
  cleanup();
  language.choose("en");
});

let drawn = 0;
const Word = memoInLanguage(function Word({ of }: { of: string }) {
  drawn += 1;
  return <p>{`${of}: ${t("Cancel goal")}`}</p>;
});

test("what is drawn apart is drawn again in another language, and not without a change", () => {
  drawn = 0;
  const { rerender } = render(<Word of="a" />);
  rerender(<Word of="a" />);
  expect(drawn).toBe(1);
  act(() => language.choose("de"));
  expect(screen.getByText("a: Ziel abbrechen")).toBeDefined();
  rerender(<Word of="b" />);
  expect(screen.getByText("b: Ziel abbrechen")).toBeDefined();
});
