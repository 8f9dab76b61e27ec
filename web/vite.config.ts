import react from "@vitejs/plugin-react";
import { loadEnv, type ProxyOptions } from "vite";
import { defineConfig } from "vitest/config";

interface Sending {
  setHeader: (name: string, value: string) => unknown;
}
interface Headers {
  origin?: string | undefined;
  host?: string | undefined;
}

/**
 * `npm run dev` hands everything but the page itself to a running console. That takes requests of
 * its own page only, so this server's address is told as the console's; that of any other site is
 * left for the console to refuse.
 */
function toConsole(console: string): ProxyOptions {
  const tellOrigin = (request: Sending, { origin, host }: Headers) => {
    if (origin === `http://${host}`) request.setHeader("origin", console);
  };
  return {
    target: console,
    changeOrigin: true,
    ws: true,
    configure: (proxy) => {
      proxy.on("proxyReq", (request, { headers }) => tellOrigin(request, headers));
      proxy.on("proxyReqWs", (request, { headers }) => tellOrigin(request, headers));
    },
  };
}

export default defineConfig(({ mode }) => {
  const { KOMPASS_CONSOLE_URL = "http://127.0.0.1:8642" } = loadEnv(mode, ".", "KOMPASS_");
  const proxy = toConsole(new URL(KOMPASS_CONSOLE_URL).origin);
  return {
    plugins: [react()],
    build: {
      outDir: "../kompass_console/static",
      emptyOutDir: true,
      // Tablets on site are rarely the newest.
      target: "es2022",
      chunkSizeWarningLimit: 700,
    },
    server: { proxy: { "/api": proxy, "/scene": proxy } },
    test: { environment: "jsdom", pool: "vmThreads", restoreMocks: true },
  };
});
