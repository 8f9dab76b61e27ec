import type { FlatExtra, FlatNews } from "../../api/types";

/** What the robot and its stack have told; null where they have told nothing. */
export interface FlatWorld extends Required<Omit<FlatNews, "type" | "extras">> {
  /** Further topics, by their names. */
  extras: Record<string, FlatExtra>;
}

export const NOTHING: FlatWorld = {
  map: null,
  local_map: null,
  path: null,
  scan: null,
  trail: null,
  footprint: null,
  goal: null,
  hindrance: null,
  extras: {},
};

/** The world after news: what they leave out is as it was. */
export function told(world: FlatWorld, { extras, ...news }: FlatNews): FlatWorld {
  const next = { ...world.extras };
  for (const [topic, shape] of Object.entries(extras ?? {})) {
    if (shape === null) delete next[topic];
    else next[topic] = shape;
  }
  return { ...world, ...news, extras: extras === undefined ? world.extras : next };
}
