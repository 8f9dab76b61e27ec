import {
  type PointerEvent,
  useCallback,
  useEffect,
  useLayoutEffect,
  useRef,
  useState,
} from "react";
import {
  type Bounds,
  type Camera,
  type Covered,
  dragged,
  type Point,
  pinched,
  type Size,
  whole,
  zoomed,
} from "./camera";

/** One notch of a mouse's wheel (100) makes a quarter more. */
const PER_WHEEL_PX = 1.00223;
const LINE_PX = 33;

interface Wishes {
  size: Size;
  /** What is to be seen at first, and by `showWhole`. */
  bounds: Bounds;
  covered: Covered;
  /** Kept in the middle, while there is something to keep there. */
  followed: Point | null;
  /** The hand has moved the map, and follows no more. */
  onMoved: () => void;
}

/** Wheel, drag and pinch on the map; its whole until one of them. */
export function useCamera({ size, bounds, covered, followed, onMoved }: Wishes) {
  const [chosen, setChosen] = useState<Camera | null>(null);
  const fitted = whole(bounds, size, covered);
  const from = (chosen: Camera | null): Camera =>
    followed === null
      ? (chosen ?? fitted)
      : { x: followed[0], y: followed[1], scale: (chosen ?? fitted).scale };
  const drawn = useRef({ from, size });
  useLayoutEffect(() => {
    drawn.current = { from, size };
  });
  const fingers = useRef(new Map<number, Point>());
  /** Dragged already, by this finger: it follows no more, though that may not be known yet. */
  const taken = useRef(false);

  // From what is chosen by then, not from what is drawn: the hand may be quicker than the screen.
  const move = useCallback((next: (camera: Camera, size: Size) => Camera) => {
    const { from, size } = drawn.current;
    const own = taken.current;
    setChosen((chosen) => next(own && chosen !== null ? chosen : from(chosen), size));
  }, []);
  const zoom = useCallback(
    (factor: number, at?: Point) =>
      move((camera, size) => zoomed(camera, size, at ?? [size.width / 2, size.height / 2], factor)),
    [move],
  );

  // React listens to the wheel passively, and the page would scroll with it.
  const root = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const element = root.current;
    if (element === null) return;
    const onWheel = (event: WheelEvent) => {
      event.preventDefault();
      const pixels = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : LINE_PX;
      zoom(PER_WHEEL_PX ** (-event.deltaY * pixels), placeIn(element, event));
    };
    element.addEventListener("wheel", onWheel, { passive: false });
    return () => element.removeEventListener("wheel", onWheel);
  }, [zoom]);

  const onPointerDown = (event: PointerEvent<HTMLElement>) => {
    if (event.button !== 0 || fingers.current.size === 2) return;
    event.currentTarget.setPointerCapture(event.pointerId);
    fingers.current.set(event.pointerId, placeIn(event.currentTarget, event));
  };
  const onPointerMove = (event: PointerEvent<HTMLElement>) => {
    const held = fingers.current;
    const was = held.get(event.pointerId);
    if (was === undefined) return;
    const now = placeIn(event.currentTarget, event);
    const before = [...held.values()];
    held.set(event.pointerId, now);
    const after = [...held.values()];
    const [a, b] = before;
    const [c, d] = after;
    move((camera, size) =>
      a !== undefined && b !== undefined && c !== undefined && d !== undefined
        ? pinched(camera, size, [a, b], [c, d])
        : dragged(camera, was, now),
    );
    if (held.size > 1) return;
    taken.current = true;
    onMoved();
  };
  const onPointerEnd = (event: PointerEvent<HTMLElement>) => {
    fingers.current.delete(event.pointerId);
    if (fingers.current.size === 0) taken.current = false;
  };

  return {
    camera: from(chosen),
    root,
    zoom,
    showWhole: useCallback(() => setChosen(null), []),
    handlers: {
      onPointerDown,
      onPointerMove,
      onPointerUp: onPointerEnd,
      onPointerCancel: onPointerEnd,
    },
  };
}

function placeIn(
  element: Element,
  { clientX, clientY }: { clientX: number; clientY: number },
): Point {
  const { left, top } = element.getBoundingClientRect();
  return [clientX - left, clientY - top];
}
