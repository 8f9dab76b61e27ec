/** The scene's colours, as in kompass_console/scene/layers/palette.py. */
export interface Colours {
  floor: string;
  obstacle: string;
  path: string;
  trail: string;
  scan: string;
  body: string;
  front: string;
  footprint: string;
  goal: string;
  preview: string;
  alert: string;
  slow: string;
}

const LIGHT: Colours = {
  floor: "#eceef0",
  obstacle: "#e27a24",
  path: "#1c6edc",
  trail: "#788696",
  scan: "#0a8482",
  body: "#28303a",
  front: "#ffffff",
  footprint: "#3a424c",
  goal: "#1c6edc",
  preview: "#5c96e8",
  alert: "#93305f",
  slow: "#b06000",
};

const DARK: Colours = {
  floor: "#171b20",
  obstacle: "#f09c48",
  path: "#60a5fa",
  trail: "#707c8c",
  scan: "#48d1cc",
  body: "#e2e7ed",
  front: "#14181d",
  footprint: "#ced5de",
  goal: "#60a5fa",
  preview: "#96c4fc",
  alert: "#ee93bf",
  slow: "#f0b050",
};

export const coloursOf = (theme: "light" | "dark"): Colours => (theme === "dark" ? DARK : LIGHT);
