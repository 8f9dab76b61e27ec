import "@mantine/core/styles.css";
import "./styles.css";
import { MantineProvider } from "@mantine/core";
import { QueryClientProvider } from "@tanstack/react-query";
import { createRoot } from "react-dom/client";
import { App } from "./App";
import { createQueryClient } from "./api/queries";
import { takeToken } from "./session/token";
import { InLanguage } from "./texts/InLanguage";
import { theme } from "./ui/theme";

// Before anything is drawn, so that the token is never on screen.
const token = takeToken();

// Where a browser takes it: over https, or on the robot itself. One that refuses says so in its own
// console, and only the page that tells of a robot out of reach is missing.
if (import.meta.env.PROD && "serviceWorker" in navigator) {
  void navigator.serviceWorker.register("/sw.js");
}

const root = document.getElementById("root");
if (root === null) throw new Error("index.html has no #root element");
const queries = createQueryClient();
createRoot(root).render(
  <InLanguage
    page={() => (
      <MantineProvider theme={theme} defaultColorScheme="auto">
        <QueryClientProvider client={queries}>
          <App token={token} />
        </QueryClientProvider>
      </MantineProvider>
    )}
  />,
);
