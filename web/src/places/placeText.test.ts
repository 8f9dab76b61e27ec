import { expect, test } from "vitest";
import type { Place } from "../api/types";
import {
  nameProblem,
  noteProblem,
  placeAt,
  placesElsewhere,
  placesHere,
  poseText,
} from "./placeText";

const place = (name: string, more: Partial<Place> = {}): Place => ({
  id: 1,
  version: 1,
  name,
  note: "",
  pose: { x: 1, y: 2, yaw: null },
  map: { id: "0".repeat(32), label: "4.0 × 3.0 m" },
  here: true,
  home: false,
  author: "ava",
  time: 0,
  ...more,
});
const names = (places: Place[]) => places.map(({ name }) => name);

test("places are listed as people count, and those of other maps are not among them", () => {
  const all = [place("Bay 10"), place("bay 2"), place("Dock"), place("Attic", { here: false })];
  expect(names(placesHere(all))).toEqual(["bay 2", "Bay 10", "Dock"]);
  expect(names(placesElsewhere(all))).toEqual(["Attic"]);
});

test("a search finds every word, in any order, without case and accents, in notes too", () => {
  const all = [place("Küche Nord"), place("Dock", { note: "north gate" }), place("Kueche")];
  expect(names(placesHere(all, "nord kuche"))).toEqual(["Küche Nord"]);
  expect(names(placesHere(all, "GATE"))).toEqual(["Dock"]);
  expect(names(placesHere(all, "  "))).toHaveLength(3);
  expect(names(placesHere(all, "attic"))).toEqual([]);
});

test("a name is told what is wrong with it before it is sent", () => {
  expect(nameProblem("Dock")).toBeNull();
  expect(nameProblem("   ")).toBe("Give the place a name.");
  expect(nameProblem("x".repeat(41))).toBe("Use at most 40 characters, not 41.");
  expect(nameProblem("🔋".repeat(40))).toBeNull();
  expect(noteProblem("x".repeat(201))).toBe("Use at most 200 characters, not 201.");
});

test("a pose says whether the heading counts", () => {
  expect(poseText({ x: -1.5, y: 2, yaw: null })).toBe("x −1.50, y 2.00 m, any heading");
  expect(poseText({ x: 0, y: 0, yaw: Math.PI / 2 })).toBe("x 0.00, y 0.00 m, heading 90°");
});

test("a goal has the name of the place it is at, and only of the map of now", () => {
  const dock = place("Dock", { pose: { x: 1, y: 2, yaw: 3.2 } });
  expect(placeAt([dock], { x: 1, y: 2, yaw: 3.2 - 2 * Math.PI })).toBe(dock);
  expect(placeAt([dock], { x: 1, y: 2, yaw: null })).toBeNull();
  expect(placeAt([dock], { x: 1.01, y: 2, yaw: 3.2 })).toBeNull();
  expect(placeAt([{ ...dock, here: false }], { x: 1, y: 2, yaw: 3.2 })).toBeNull();
});
