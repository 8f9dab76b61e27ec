import "@mantine/core/styles.css";
import "./styles.css";
import { MantineProvider } from "@mantine/core";
import { createRoot } from "react-dom/client";
import { App } from "./App";
import { takeToken } from "./session/token";
import { theme } from "./ui/theme";

// Before anything is drawn, so that the token is never on screen.
const token = takeToken();

const root = document.getElementById("root");
if (root === null) throw new Error("index.html has no #root element");
createRoot(root).render(
  <MantineProvider theme={theme} defaultColorScheme="auto">
    <App token={token} />
  </MantineProvider>,
);
