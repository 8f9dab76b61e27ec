// @vitest-environment node
import { onlineManager } from "@tanstack/react-query";
import { afterEach, expect, test, vi } from "vitest";
import { stopRobot } from "./client";
import { answer, given, within } from "./http";

const fetch = vi.hoisted(() => {
  const fetch = vi.fn<(request: Request) => Promise<Response>>();
  Object.assign(globalThis, { fetch, location: { origin: "http://console" } });
  return fetch;
});

const refusal = { detail: { title: "Not now.", remedy: "Wait." }, conflict: { revision: 3 } };
const failed = (status: number, error?: unknown) =>
  answer(Promise.resolve({ error, response: new Response(null, { status }) }));

afterEach(() => {
  onlineManager.setOnline(true);
});

test("STOP goes out at once from a browser that believes itself offline", async () => {
  onlineManager.setOnline(false);
  fetch.mockResolvedValue(Response.json({ accepted: true, message: "" }));
  await expect(stopRobot()).resolves.toMatchObject({ accepted: true });
  const [request] = fetch.mock.calls[0] ?? [];
  expect(request?.method).toBe("POST");
  expect(request?.url).toBe("http://console/api/stop");
});

test("a refusal is told in the server's own words, with all that came with it", async () => {
  await expect(failed(409, refusal)).rejects.toMatchObject({
    status: 409,
    title: "Not now.",
    remedy: "Wait.",
    body: refusal,
  });
});

test("the error page of a proxy is told by its status", async () => {
  await expect(failed(502, "<html>")).rejects.toMatchObject({
    title: "The console answered with error 502.",
  });
});

test("a request without an answer in time says so, one that its caller gave up does not", async () => {
  const until = (signal: AbortSignal) =>
    answer(
      new Promise<never>((_, reject) => {
        signal.addEventListener("abort", () => reject(signal.reason));
      }),
    );
  await expect(until(within(5))).rejects.toMatchObject({ status: 0 });
  const caller = new AbortController();
  const left = until(within(60_000, caller.signal));
  caller.abort();
  await expect(left).rejects.toMatchObject({ name: "AbortError" });
});

test("a parameter without a value is not sent", () => {
  expect(given({ before: null, count: 0, rule_id: "" })).toEqual({ count: 0, rule_id: "" });
});
