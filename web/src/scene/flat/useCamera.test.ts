import { act, renderHook } from "@testing-library/react";
import { type PointerEvent, useLayoutEffect, useRef } from "react";
import { expect, test, vi } from "vitest";
import type { Point } from "./camera";
import { useCamera } from "./useCamera";

const canvas = document.createElement("canvas");
canvas.setPointerCapture = vi.fn();

const finger = (pointerId: number, clientX: number, clientY = 300) =>
  ({
    button: 0,
    pointerId,
    clientX,
    clientY,
    currentTarget: canvas,
  }) as unknown as PointerEvent<HTMLElement>;

const ROOM = {
  size: { width: 800, height: 600 },
  bounds: [-4, -3, 4, 3],
  covered: { top: 0, right: 0 },
} as const;

function looking(followed: Point | null = null) {
  return renderHook(
    (props: { followed: Point | null }) =>
      useCamera({
        ...ROOM,
        followed: props.followed,
        onMoved: vi.fn(),
      }),
    { initialProps: { followed } },
  );
}

test("no step of a pinch is lost that comes while the picture of the one before is drawn", () => {
  const steps = [80, 100, 120].flatMap((apart) => [finger(0, 400 - apart), finger(1, 400 + apart)]);
  const { result } = renderHook(() => {
    const looked = useCamera({ ...ROOM, followed: null, onMoved: vi.fn() });
    // Drawn is what was wished, but what React does after drawing is still to come.
    useLayoutEffect(() => {
      const step = looked.camera.scale === first.current ? undefined : steps.shift();
      if (step !== undefined) looked.handlers.onPointerMove(step);
    });
    const first = useRef(looked.camera.scale);
    return looked;
  });
  const { camera, handlers } = result.current;
  const step = steps.shift();
  act(() => {
    handlers.onPointerDown(finger(0, 340));
    handlers.onPointerDown(finger(1, 460));
    if (step !== undefined) handlers.onPointerMove(step);
  });
  expect(steps).toEqual([]);
  expect(result.current.camera.scale).toBeCloseTo(2 * camera.scale);
});

test("a map that follows the robot is dragged from where it is, as far as the hand goes", () => {
  const { result, rerender } = looking([1, 1]);
  const { camera, handlers } = result.current;
  act(() => {
    handlers.onPointerDown(finger(0, 400));
    handlers.onPointerMove(finger(0, 410));
    handlers.onPointerMove(finger(0, 430));
    handlers.onPointerUp(finger(0, 430));
  });
  rerender({ followed: null });
  expect(result.current.camera.x).toBeCloseTo(1 - 30 / camera.scale);
  expect(result.current.camera.y).toBeCloseTo(1);
});
