import react from "@vitejs/plugin-react";
import { defineConfig } from "vitest/config";

/** The console that `npm run dev` talks to. */
const CONSOLE = "http://127.0.0.1:8642";

export default defineConfig({
  plugins: [react()],
  build: {
    outDir: "../kompass_console/static",
    emptyOutDir: true,
    // Tablets on site are rarely the newest.
    target: "es2022",
    chunkSizeWarningLimit: 700,
  },
  server: {
    proxy: {
      "/api": { target: CONSOLE, ws: true },
      "/scene": { target: CONSOLE, ws: true },
    },
  },
  test: { environment: "jsdom", pool: "vmThreads", restoreMocks: true },
});
