// @vitest-environment jsdom
import { MantineProvider } from "@mantine/core";
import { act, cleanup, renderHook } from "@testing-library/react";
import { afterEach, expect, test, vi } from "vitest";
import { useTheme } from "./theme";

afterEach(() => {
  cleanup();
  localStorage.clear();
});

test.each([
  ["light", ["dark", "light", "auto"]],
  ["dark", ["light", "dark", "auto"]],
])("each press but the last is to be seen where the system is %s", (system, choices) => {
  vi.stubGlobal("matchMedia", (query: string) => ({
    matches: query.includes(`: ${system}`),
    addEventListener: () => {},
    removeEventListener: () => {},
  }));
  const { result } = renderHook(useTheme, {
    wrapper: ({ children }) => (
      <MantineProvider defaultColorScheme="auto">{children}</MantineProvider>
    ),
  });
  const seen = choices.map(() => {
    act(() => result.current.cycle());
    return result.current.choice;
  });
  expect(seen).toEqual(choices);
});
