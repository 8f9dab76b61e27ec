import { act, renderHook } from "@testing-library/react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { checkGoal, sendGoal } from "../api/client";
import { noAnswer } from "../api/errors";
import { goalCheck } from "./fixtures";
import { SAY_SENDING_AFTER_MS, useGoalTool } from "./useGoalTool";

vi.mock("../api/client");

type Sent = Awaited<ReturnType<typeof sendGoal>>;
const SENT: Sent = { id: "g", topic: "/clicked_point", heading_used: false, note: "" };

beforeEach(() => {
  vi.useFakeTimers();
  vi.mocked(checkGoal).mockResolvedValue(goalCheck);
});
afterEach(() => {
  vi.useRealTimers();
  vi.resetAllMocks();
});

function answering() {
  let resolve: (sent: Sent) => void = () => {};
  let reject: (error: unknown) => void = () => {};
  const promise = new Promise<Sent>((answer, refuse) => {
    resolve = answer;
    reject = refuse;
  });
  return { promise, resolve, reject };
}

/** A tool with a goal that was checked, and what answers when it is sent. */
async function checked() {
  const sent = answering();
  vi.mocked(sendGoal).mockReturnValue(sent.promise);
  const { result } = renderHook(() => useGoalTool(null));
  await act(async () => result.current.check({ x: 1, y: 2, yaw: null }, null));
  expect(result.current.draft?.phase).toBe("checked");
  return { result, sent };
}
const wait = (ms: number) => act(() => vi.advanceTimersByTimeAsync(ms));

test("who presses Go twice sends one goal, before and after it is said that it is being sent", async () => {
  const { result } = await checked();
  act(() => result.current.go());
  act(() => result.current.go());
  await wait(SAY_SENDING_AFTER_MS);
  act(() => result.current.go());
  expect(sendGoal).toHaveBeenCalledTimes(1);
});

test("a goal that is sent at once is gone from the card without a word in between", async () => {
  const { result, sent } = await checked();
  act(() => result.current.go());
  expect(result.current.draft?.phase).toBe("checked");
  await act(async () => sent.resolve(SENT));
  expect(result.current.draft).toBeNull();
  await wait(SAY_SENDING_AFTER_MS);
  expect(result.current.draft).toBeNull();
});

test("a console that takes its time is said to be asked, and its refusal can be tried again", async () => {
  const { result, sent } = await checked();
  act(() => result.current.go());
  await wait(SAY_SENDING_AFTER_MS);
  expect(result.current.draft?.phase).toBe("sending");
  await act(async () => sent.reject(noAnswer()));
  expect(result.current.draft).toMatchObject({ phase: "checked", error: noAnswer() });
  act(() => result.current.go());
  expect(sendGoal).toHaveBeenCalledTimes(2);
});

test("what was dropped while it was being sent does not come back", async () => {
  const { result } = await checked();
  act(() => result.current.go());
  act(() => result.current.drop());
  await wait(SAY_SENDING_AFTER_MS);
  expect(result.current.draft).toBeNull();
});
