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
  /** Of further topics, which share them. */
  extras: readonly string[];
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
  extras: ["#703ab2", "#2e7d32", "#965418", "#18607a", "#a8247a"],
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
  extras: ["#be96fa", "#81c784", "#e0aa6e", "#6ec4e2", "#f08cd0"],
};

export const coloursOf = (theme: "light" | "dark"): Colours => (theme === "dark" ? DARK : LIGHT);

/** The colour of a topic, the same one as in the scene. */
export function extraColour(topic: string, { extras }: Colours): string {
  const sum = new TextEncoder().encode(topic).reduce((all, each) => all + each, 0);
  return extras[sum % extras.length] ?? "";
}
