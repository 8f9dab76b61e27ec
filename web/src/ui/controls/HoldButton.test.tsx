import { act, cleanup, fireEvent, screen } from "@testing-library/react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { renderPlain } from "../testing";
import { HOLD_MS, HoldButton } from "./HoldButton";

beforeEach(() => {
  vi.useFakeTimers();
});
afterEach(() => {
  cleanup();
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

function button() {
  const onHeld = vi.fn();
  renderPlain(
    <HoldButton label="Release" onHeld={onHeld}>
      Hold
    </HoldButton>,
  );
  return { onHeld, element: screen.getByRole("button", { name: "Release" }) };
}
const wait = (ms: number) => act(() => vi.advanceTimersByTime(ms));

test("a full hold acts once, with no need to let go", () => {
  const { onHeld, element } = button();
  fireEvent.pointerDown(element, { button: 0 });
  wait(HOLD_MS);
  expect(onHeld).toHaveBeenCalledTimes(1);
  wait(3 * HOLD_MS);
  expect(onHeld).toHaveBeenCalledTimes(1);
});

test.each(["pointerUp", "pointerLeave", "pointerCancel", "blur"] as const)(
  "%s before the second is over releases nothing",
  (end) => {
    const { onHeld, element } = button();
    fireEvent.pointerDown(element, { button: 0 });
    wait(HOLD_MS - 1);
    fireEvent[end](element);
    wait(HOLD_MS);
    expect(onHeld).not.toHaveBeenCalled();
  },
);

test("a click is not a hold", () => {
  const { onHeld, element } = button();
  fireEvent.click(element);
  wait(2 * HOLD_MS);
  expect(onHeld).not.toHaveBeenCalled();
});

test("holding Enter works, and Space is never a release", () => {
  const { onHeld, element } = button();
  fireEvent.keyDown(element, { key: " " });
  wait(2 * HOLD_MS);
  expect(onHeld).not.toHaveBeenCalled();
  fireEvent.keyDown(element, { key: "Enter" });
  fireEvent.keyDown(element, { key: "Enter", repeat: true });
  wait(HOLD_MS);
  expect(onHeld).toHaveBeenCalledTimes(1);
});
