import { MantineProvider } from "@mantine/core";
import { QueryClient, QueryClientProvider } from "@tanstack/react-query";
import { render } from "@testing-library/react";
import type { ReactNode } from "react";
import { vi } from "vitest";

/** Renders within what Mantine and queries need; jsdom knows neither the system's theme nor sizes. */
export function renderPlain(children: ReactNode) {
  vi.stubGlobal("matchMedia", () => ({
    matches: false,
    addEventListener: () => {},
    removeEventListener: () => {},
  }));
  vi.stubGlobal(
    "ResizeObserver",
    class {
      observe() {}
      unobserve() {}
      disconnect() {}
    },
  );
  Element.prototype.scrollIntoView = () => {};
  const client = new QueryClient();
  return render(children, {
    wrapper: ({ children: within }) => (
      <QueryClientProvider client={client}>
        <MantineProvider env="test">{within}</MantineProvider>
      </QueryClientProvider>
    ),
  });
}
