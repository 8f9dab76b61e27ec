import { expect, test } from "vitest";
import { arrowHead, DRAG_PX, isDrag, placeCard, toScene } from "./gesture";

const scene = { left: 72, top: 44, width: 1000, height: 800 };

test("a trembling tap is a tap, a longer stroke is a heading", () => {
  expect(isDrag({ x: 0, y: 0 }, { x: DRAG_PX, y: 0 })).toBe(false);
  expect(isDrag({ x: 0, y: 0 }, { x: 9, y: 9 })).toBe(true);
});

test("a page position becomes a fraction of the scene, right and down", () => {
  expect(toScene({ x: 572, y: 244 }, scene)).toEqual([0.5, 0.25]);
});

test("a release outside the scene counts at its edge", () => {
  expect(toScene({ x: 2000, y: 0 }, scene)).toEqual([1, 0]);
});

test("the arrow's head opens backwards from its tip", () => {
  const [tip, a, b] = arrowHead({ x: 0, y: 0 }, { x: 100, y: 0 }, 20);
  expect(tip).toEqual({ x: 100, y: 0 });
  expect(a.x).toBeLessThan(100);
  expect(b.x).toBeCloseTo(a.x);
  expect(a.y).toBeCloseTo(-b.y);
});

test.each([
  ["the middle", { x: 500, y: 400 }],
  ["the top left corner", { x: 72, y: 44 }],
  ["the bottom right corner", { x: 1072, y: 844 }],
] as const)("a card at %s is wholly inside the scene, on either side", (_where, anchor) => {
  const card = { width: 300, height: 140 };
  for (const side of ["above", "below"] as const) {
    const at = placeCard(anchor, card, scene, side);
    expect(at.x).toBeGreaterThanOrEqual(scene.left);
    expect(at.y).toBeGreaterThanOrEqual(scene.top);
    expect(at.x + card.width).toBeLessThanOrEqual(scene.left + scene.width);
    expect(at.y + card.height).toBeLessThanOrEqual(scene.top + scene.height);
  }
});

test("a card never covers the arrow that it is about, where there is room", () => {
  const card = { width: 300, height: 140 };
  const anchor = { x: 500, y: 400 };
  expect(placeCard(anchor, card, scene, "above").y + card.height).toBeLessThan(anchor.y);
  expect(placeCard(anchor, card, scene, "below").y).toBeGreaterThan(anchor.y);
});

test("a card larger than the scene starts at its corner", () => {
  const at = placeCard(
    { x: 50, y: 50 },
    { width: 300, height: 300 },
    { left: 0, top: 0, width: 200, height: 200 },
  );
  expect(at).toEqual({ x: 8, y: 8 });
});
