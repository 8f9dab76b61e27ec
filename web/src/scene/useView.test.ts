import { expect, test } from "vitest";
import type { View } from "../api/types";
import { merge } from "./useView";

const view: View = {
  id: "a",
  follow: false,
  top: false,
  theme: "light",
  layers: {
    map: true,
    local_map: true,
    path: true,
    scan: true,
    robot: true,
    goal: true,
    trail: true,
    places: true,
    zones: true,
  },
  extras: ["/other/plan"],
};

test("a switched layer changes that layer alone", () => {
  const next = merge(view, { layers: { scan: false } });
  expect(next).toEqual({ ...view, layers: { ...view.layers, scan: false } });
});

test("further layers are switched as a whole list", () => {
  expect(merge(view, { extras: [] })).toEqual({ ...view, extras: [] });
});

test("what a change leaves out or leaves null stays as it was", () => {
  expect(merge(view, { follow: true, top: null })).toEqual({ ...view, follow: true });
});
