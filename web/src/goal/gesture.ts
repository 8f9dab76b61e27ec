/** The goal gesture: a tap is a point; press, drag and release is a point with a heading. */

export interface Px {
  x: number;
  y: number;
}

export interface Box {
  left: number;
  top: number;
  width: number;
  height: number;
}

/** A finger trembles: shorter drags are taps. */
export const DRAG_PX = 12;

export function isDrag(start: Px, end: Px): boolean {
  return Math.hypot(end.x - start.x, end.y - start.y) > DRAG_PX;
}

/** A page position as fractions of the scene (u right, v down), kept inside it. */
export function toScene(point: Px, scene: Box): [number, number] {
  return [
    clamp((point.x - scene.left) / scene.width, 0, 1),
    clamp((point.y - scene.top) / scene.height, 0, 1),
  ];
}

/** The three corners of an arrow head of `size` px at `tip`, pointing away from `tail`. */
export function arrowHead(tail: Px, tip: Px, size: number): [Px, Px, Px] {
  const angle = Math.atan2(tip.y - tail.y, tip.x - tail.x);
  const corner = (turn: number): Px => ({
    x: tip.x - size * Math.cos(angle + turn),
    y: tip.y - size * Math.sin(angle + turn),
  });
  return [tip, corner(0.45), corner(-0.45)];
}

const GAP = 16;

/**
 * Where a card of `card` size goes so that it is beside the pointer but inside the viewport:
 * on the wanted side of it, else on the other one.
 */
export function placeCard(
  anchor: Px,
  card: { width: number; height: number },
  viewport: Box,
  side: "above" | "below" = "below",
  margin = 8,
): Px {
  const right = viewport.left + viewport.width;
  const bottom = viewport.top + viewport.height;
  const x = clamp(
    anchor.x - card.width / 2,
    viewport.left + margin,
    Math.max(viewport.left + margin, right - margin - card.width),
  );
  const below = anchor.y + GAP;
  const above = anchor.y - GAP - card.height;
  const top = viewport.top + margin;
  const lowest = Math.max(top, bottom - margin - card.height);
  const first = side === "below" ? below : above;
  const second = side === "below" ? above : below;
  const fits = (at: number) => at >= top && at <= lowest;
  return { x, y: fits(first) ? first : clamp(second, top, lowest) };
}

function clamp(value: number, low: number, high: number): number {
  return Math.min(high, Math.max(low, value));
}
