import { type CSSProperties, type RefObject, useLayoutEffect, useRef, useState } from "react";
import type { Anchor } from "./GestureOverlay";
import { type Px, placeCard } from "./gesture";

interface CardPlace {
  card: RefObject<HTMLDivElement | null>;
  /** Null until the card was measured. */
  place: Px | null;
  style: CSSProperties;
}

/**
 * Puts a card beside the hand and inside the scene.
 *
 * @param anchor null when nothing was pressed
 * @param said what the card says: its size follows
 * @param away where it is when nothing was pressed
 */
export function useCardPlace(
  anchor: Anchor | null,
  said: unknown[],
  away: "middle" | "corner" = "middle",
): CardPlace {
  const card = useRef<HTMLDivElement>(null);
  const [place, setPlace] = useState<Px | null>(null);
  useLayoutEffect(() => {
    const parent = card.current?.offsetParent;
    if (card.current === null || !(parent instanceof HTMLElement)) return;
    const box = parent.getBoundingClientRect();
    const size = { width: card.current.offsetWidth, height: card.current.offsetHeight };
    const otherwise = {
      middle: { x: box.left + box.width / 2, y: box.top + box.height / 3 },
      corner: { x: box.right, y: box.bottom },
    };
    const { x, y } = placeCard(anchor?.at ?? otherwise[away], size, box, anchor?.side);
    setPlace({ x: x - box.left, y: y - box.top });
  }, [anchor, away, ...said]);
  const style: CSSProperties =
    place === null ? { visibility: "hidden" } : { left: place.x, top: place.y };
  return { card, place, style };
}
