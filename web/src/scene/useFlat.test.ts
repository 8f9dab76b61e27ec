import { act, renderHook } from "@testing-library/react";
import { beforeEach, expect, test, vi } from "vitest";

const draws = vi.hoisted(() => vi.fn(() => true));
vi.mock("./webgl", () => ({ drawsWebGl: draws }));

import { useFlat } from "./useFlat";

beforeEach(() => {
  localStorage.clear();
  draws.mockReturnValue(true);
});

test("a chosen flat map is remembered by the browser, and so is the way back", () => {
  const { result } = renderHook(useFlat);
  expect(result.current.flat).toBe(false);
  act(() => result.current.toggle());
  expect(result.current.flat).toBe(true);
  expect(renderHook(useFlat).result.current.flat).toBe(true);
  act(() => result.current.toggle());
  expect(renderHook(useFlat).result.current.flat).toBe(false);
});

test("without WebGL the map is flat, whatever was chosen, and there is no choice", () => {
  draws.mockReturnValue(false);
  const { flat, choice } = renderHook(useFlat).result.current;
  expect([flat, choice]).toEqual([true, false]);
});
