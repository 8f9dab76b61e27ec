import { cleanup, fireEvent, screen, waitFor } from "@testing-library/react";
import { afterEach, expect, test, vi } from "vitest";
import { renderPlain } from "../testing";
import { Picker } from "./Picker";

afterEach(() => {
  cleanup();
  vi.unstubAllGlobals();
});

test("what was typed to find a thing is gone once it is taken, and hides nothing the next time", async () => {
  const onPick = vi.fn();
  renderPlain(<Picker aria-label="Component" data={["controller", "planner"]} onPick={onPick} />);
  const search = screen.getByRole<HTMLInputElement>("combobox");
  fireEvent.click(search);
  // What comes while the focus is elsewhere is the browser filling it in, and not typed.
  search.focus();
  fireEvent.change(search, { target: { value: "plan" } });
  await waitFor(() => expect(screen.queryByRole("option", { name: "controller" })).toBeNull());
  fireEvent.click(screen.getByRole("option", { name: "planner" }));
  expect(onPick).toHaveBeenCalledWith("planner");
  expect(search.value).toBe("");
  fireEvent.click(search);
  expect(screen.getByRole("option", { name: "controller" })).toBeTruthy();
});
