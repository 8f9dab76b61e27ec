import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { backoff } from "../api/socket";
import { RobotLink } from "./link";

/** A socket that the test speaks for. */
class FakeSocket {
  static all: FakeSocket[] = [];
  onmessage: ((event: { data: string }) => void) | null = null;
  onclose: (() => void) | null = null;
  closed = false;
  constructor(readonly url: string) {
    FakeSocket.all.push(this);
  }
  close() {
    this.closed = true;
  }
  say(message: object) {
    this.onmessage?.({ data: JSON.stringify(message) });
  }
}
const socket = (): FakeSocket => {
  const last = FakeSocket.all.at(-1);
  if (last === undefined) throw new Error("no socket was opened");
  return last;
};
const hello = { type: "hello", session: { user: "ava", role: "operator" }, version: "1" };
const snapshot = (seq: number) => ({ type: "state", seq });

beforeEach(() => {
  vi.useFakeTimers();
  FakeSocket.all = [];
  vi.stubGlobal("WebSocket", FakeSocket);
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

function opened(onRefused = () => {}) {
  const link = new RobotLink(onRefused);
  link.open();
  return link;
}

test("a burst of snapshots is told once, and the newest wins", () => {
  const link = opened();
  const told = vi.fn();
  link.subscribe(told);
  socket().say(hello);
  for (const seq of [1, 2, 5, 4]) socket().say(snapshot(seq));
  vi.advanceTimersByTime(1);
  expect(told).toHaveBeenCalledTimes(1);
  expect(link.getSnapshot().state?.seq).toBe(5);
});

test("a restarted server counts from one again and is believed", () => {
  const link = opened();
  socket().say(hello);
  socket().say(snapshot(900));
  socket().onclose?.();
  expect(link.getSnapshot().connected).toBe(false);
  vi.advanceTimersByTime(backoff(0));
  socket().say(hello);
  socket().say(snapshot(1));
  expect(link.getSnapshot()).toMatchObject({ connected: true, connection: 2, state: { seq: 1 } });
});

test("the wait between attempts grows from half a second to three", () => {
  expect([0, 1, 2, 3, 9].map(backoff)).toEqual([500, 1000, 2000, 3000, 3000]);
  opened();
  for (let attempt = 0; attempt < 4; attempt++) {
    const before = FakeSocket.all.length;
    socket().onclose?.();
    vi.advanceTimersByTime(backoff(attempt) - 1);
    expect(FakeSocket.all.length).toBe(before);
    vi.advanceTimersByTime(1);
    expect(FakeSocket.all.length).toBe(before + 1);
  }
});

test("a connection that stays open but says nothing is given up", () => {
  const link = opened();
  socket().say(hello);
  socket().say(snapshot(1));
  const first = socket();
  vi.advanceTimersByTime(4000);
  expect(first.closed).toBe(true);
  expect(link.getSnapshot().connected).toBe(false);
  vi.advanceTimersByTime(backoff(0));
  expect(socket()).not.toBe(first);
});

test("a refusal before the first message is reported, a lost connection is not", () => {
  const refused = vi.fn();
  opened(refused);
  socket().say(hello);
  socket().onclose?.();
  expect(refused).not.toHaveBeenCalled();
  vi.advanceTimersByTime(backoff(0));
  socket().onclose?.();
  expect(refused).toHaveBeenCalledTimes(1);
});

test("a closed link stays closed", () => {
  const link = opened();
  link.close();
  socket().onclose?.();
  vi.advanceTimersByTime(10_000);
  expect(FakeSocket.all.length).toBe(1);
});
