/** Looking at the floor from straight above, x to the right and y up. */

export interface Camera {
  /** What is in the middle, m. */
  x: number;
  y: number;
  /** Pixels for a metre. */
  scale: number;
}

export interface Size {
  width: number;
  height: number;
}

/** A place on the picture, from its upper left corner, or on the floor, m. */
export type Point = readonly [number, number];
export type Bounds = readonly [number, number, number, number];

const SMALLEST = 0.2;
const LARGEST = 600;
/** Of the picture, on each side of what is shown whole. */
const MARGIN = 0.06;

export const toPicture = ({ x, y, scale }: Camera, size: Size, at: Point): Point => [
  size.width / 2 + (at[0] - x) * scale,
  size.height / 2 - (at[1] - y) * scale,
];

export const toFloor = ({ x, y, scale }: Camera, size: Size, at: Point): Point => [
  x + (at[0] - size.width / 2) / scale,
  y - (at[1] - size.height / 2) / scale,
];

/** Pixels of the picture's edges that something lies over. */
export interface Covered {
  top: number;
  right: number;
}

/** Everything within (x0, y0, x1, y1), as large as it fits into what is not covered. */
export function whole([x0, y0, x1, y1]: Bounds, size: Size, { top, right }: Covered): Camera {
  const room = 1 - 2 * MARGIN;
  const scale = within(
    Math.min(
      (Math.max(size.width - right, 1) * room) / Math.max(x1 - x0, 0.01),
      (Math.max(size.height - top, 1) * room) / Math.max(y1 - y0, 0.01),
    ),
  );
  return { x: (x0 + x1 + right / scale) / 2, y: (y0 + y1 + top / scale) / 2, scale };
}

/** The floor that was under `from` comes to lie under `to`. */
export function dragged(camera: Camera, from: Point, to: Point): Camera {
  return {
    ...camera,
    x: camera.x - (to[0] - from[0]) / camera.scale,
    y: camera.y + (to[1] - from[1]) / camera.scale,
  };
}

/** Larger by a factor; what is under the pointer stays there. */
export function zoomed(camera: Camera, size: Size, at: Point, factor: number): Camera {
  const scale = within(camera.scale * factor);
  const [x, y] = toFloor(camera, size, at);
  return {
    scale,
    x: x - (at[0] - size.width / 2) / scale,
    y: y + (at[1] - size.height / 2) / scale,
  };
}

/** Two fingers: the floor between them moves and grows with them. */
export function pinched(
  camera: Camera,
  size: Size,
  before: readonly [Point, Point],
  after: readonly [Point, Point],
): Camera {
  const apart = distance(before);
  const factor = apart === 0 ? 1 : distance(after) / apart;
  return zoomed(dragged(camera, middle(before), middle(after)), size, middle(after), factor);
}

const within = (scale: number) => Math.min(LARGEST, Math.max(SMALLEST, scale));
const distance = ([a, b]: readonly [Point, Point]) => Math.hypot(b[0] - a[0], b[1] - a[1]);
const middle = ([a, b]: readonly [Point, Point]): Point => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
