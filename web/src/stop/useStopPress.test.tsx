import { act, renderHook } from "@testing-library/react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { ApiError, noAnswer } from "../api/errors";
import type { StopEvent } from "./stopMachine";
import { AGAIN_MS, useStopPress } from "./useStopPress";

beforeEach(() => vi.useFakeTimers());
afterEach(() => vi.useRealTimers());

function pressing(send: () => Promise<{ accepted: boolean; message: string }>) {
  const said: StopEvent[] = [];
  const dispatch = (event: StopEvent) => said.push(event);
  const { result, rerender, unmount } = renderHook(
    ({ reached }) => useStopPress(send, dispatch, reached),
    { initialProps: { reached: false } },
  );
  return {
    said,
    press: () => result.current.press(),
    look: () => result.current.giveUp(),
    see: () => rerender({ reached: true }),
    unmount,
  };
}
const later = (times = 1) => act(() => vi.advanceTimersByTimeAsync(times * AGAIN_MS));
const accepted = { accepted: true, message: "" };

test("STOP is sent again until the console answers, and then no more", async () => {
  const send = vi.fn().mockRejectedValue(noAnswer());
  const { said, press } = pressing(send);
  press();
  await later(3);
  expect(send).toHaveBeenCalledTimes(4);
  expect(said.at(-1)).toMatchObject({
    type: "refused",
    problem: expect.stringContaining("sent again until it does"),
  });
  send.mockResolvedValue(accepted);
  await later(5);
  expect(send).toHaveBeenCalledTimes(5);
});

test("a page that is left goes on sending it", async () => {
  const send = vi.fn().mockRejectedValue(noAnswer());
  const { press, unmount } = pressing(send);
  press();
  await later();
  unmount();
  await later();
  expect(send).toHaveBeenCalledTimes(3);
});

test("who has looked ends it", async () => {
  const send = vi.fn().mockRejectedValue(noAnswer());
  const { press, look } = pressing(send);
  press();
  await later();
  look();
  await later(3);
  expect(send).toHaveBeenCalledTimes(2);
});

test("a console that answers that it cannot is not asked again by itself", async () => {
  const send = vi.fn().mockRejectedValue(new ApiError(503, "STOP is not confirmed.", "Look."));
  const { said, press } = pressing(send);
  press();
  await later(3);
  expect(send).toHaveBeenCalledTimes(1);
  expect(said.at(-1)).toMatchObject({ type: "refused", problem: "STOP is not confirmed." });
});

test("a second press is sent at once, and takes the place of the first", async () => {
  const send = vi.fn().mockRejectedValue(noAnswer());
  const { press } = pressing(send);
  press();
  await later(0.5);
  press();
  await later(0);
  expect(send).toHaveBeenCalledTimes(2);
  await later();
  expect(send).toHaveBeenCalledTimes(3);
});

test("a robot that is seen to be stopped is not stopped once more, after its release", async () => {
  const send = vi.fn().mockRejectedValue(noAnswer());
  const { press, see } = pressing(send);
  press();
  await later();
  see();
  await later(3);
  expect(send).toHaveBeenCalledTimes(2);
});
