import type { FlatNews } from "../../api/types";

/** What the robot and its stack have told; null where they have told nothing. */
export type FlatWorld = Required<Omit<FlatNews, "type">>;

export const NOTHING: FlatWorld = {
  map: null,
  local_map: null,
  path: null,
  scan: null,
  trail: null,
  footprint: null,
  goal: null,
  hindrance: null,
};

/** The world after news: what they leave out is as it was. */
export const told = (world: FlatWorld, news: FlatNews): FlatWorld => ({ ...world, ...news });
