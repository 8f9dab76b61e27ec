/** The two tables of a drill: how they are called, and which shape their robots have. */
export const SIDES = [
  { side: "proposed", name: "Proposed", shape: "▶" },
  { side: "in_force", name: "In force", shape: "▷" },
] as const;
