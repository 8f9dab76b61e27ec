import { expect, test } from "vitest";
import { type Camera, dragged, pinched, toFloor, toPicture, whole, zoomed } from "./camera";

const size = { width: 800, height: 600 };
const camera: Camera = { x: 2, y: -1, scale: 50 };

test("a place of the floor and its pixel lead to each other, with y up", () => {
  expect(toPicture(camera, size, [2, -1])).toEqual([400, 300]);
  expect(toPicture(camera, size, [3, 0])).toEqual([450, 250]);
  expect(toFloor(camera, size, [450, 250])).toEqual([3, 0]);
});

test("the whole map is within the picture, and as large as it fits", () => {
  const shown = whole([-1, -2, 9, 2], size, { top: 0, right: 0 });
  const [left, top] = toPicture(shown, size, [-1, 2]);
  const [right, bottom] = toPicture(shown, size, [9, -2]);
  expect(left).toBeGreaterThan(0);
  expect(right).toBeLessThan(800);
  expect(right - left).toBeGreaterThan(650);
  expect(top + bottom).toBeCloseTo(600);
});

test("the whole map is clear of what lies over the picture", () => {
  const shown = whole([-1, -2, 9, 2], { width: 800, height: 300 }, { top: 74, right: 56 });
  const [left, top] = toPicture(shown, { width: 800, height: 300 }, [-1, 2]);
  const [right, bottom] = toPicture(shown, { width: 800, height: 300 }, [9, -2]);
  expect(top).toBeGreaterThan(74);
  expect(bottom).toBeLessThan(300);
  expect(right).toBeLessThan(744);
  expect(left).toBeGreaterThan(0);
});

test("what is dragged stays under the finger", () => {
  const under = toFloor(camera, size, [100, 100]);
  const then = dragged(camera, [100, 100], [180, 70]);
  const [x, y] = toFloor(then, size, [180, 70]);
  expect(x).toBeCloseTo(under[0]);
  expect(y).toBeCloseTo(under[1]);
});

test("the wheel zooms at the pointer, and not without bounds", () => {
  const under = toFloor(camera, size, [120, 500]);
  const then = zoomed(camera, size, [120, 500], 2);
  expect(then.scale).toBe(100);
  const [x, y] = toFloor(then, size, [120, 500]);
  expect(x).toBeCloseTo(under[0]);
  expect(y).toBeCloseTo(under[1]);
  expect(zoomed(camera, size, [0, 0], 1e9).scale).toBeLessThan(1e4);
  expect(zoomed(camera, size, [0, 0], 1e-9).scale).toBeGreaterThan(0.01);
});

test("two fingers take the floor between them along, and what is under each of them", () => {
  const then = pinched(
    camera,
    size,
    [
      [200, 300],
      [400, 300],
    ],
    [
      [250, 350],
      [650, 350],
    ],
  );
  expect(then.scale).toBe(100);
  for (const [before, after] of [
    [
      [200, 300],
      [250, 350],
    ],
    [
      [400, 300],
      [650, 350],
    ],
  ] as const) {
    const [x, y] = toFloor(then, size, after);
    const [wasX, wasY] = toFloor(camera, size, before);
    expect(x).toBeCloseTo(wasX);
    expect(y).toBeCloseTo(wasY);
  }
});

test("two fingers at one place do not blow the map up", () => {
  expect(
    pinched(
      camera,
      size,
      [
        [9, 9],
        [9, 9],
      ],
      [
        [0, 0],
        [50, 0],
      ],
    ).scale,
  ).toBe(50);
});
