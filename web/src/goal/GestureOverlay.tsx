import { type PointerEvent, useRef, useState } from "react";
import type { GoalPick, GoalPoint } from "../api/types";
import classes from "./Goal.module.css";
import { arrowHead, isDrag, type Px, toScene } from "./gesture";

/** Where the pointer was let go (page pixels), and which side of it the drawn arrow leaves free. */
export interface Anchor {
  at: Px;
  side: "above" | "below";
}

/** What a gesture means, of which start and end are fractions of the scene (u right, v down). */
export type PickOf<P = GoalPick | GoalPoint> = (
  start: [number, number],
  end: [number, number] | null,
) => P;

interface Props<P> {
  /** Of its test ids. */
  name: string;
  pick: PickOf<P>;
  /** The console has not drawn the last gesture into the scene yet: so it is kept here. */
  waits: boolean;
  onPick: (pick: P, anchor: Anchor) => void;
  /** While the pointer is down and has moved. */
  onDrag?: (pick: P) => void;
}

interface Stroke {
  pointer: number;
  start: Px;
  end: Px;
}

/**
 * Lies over the scene while a tool is on that is used by pressing on the floor. Draws the gesture
 * itself, so that the arrow is under the pointer in the same frame, whatever the network does.
 */
export function GestureOverlay<P>({ name, pick, waits, onPick, onDrag }: Props<P>) {
  const root = useRef<HTMLDivElement>(null);
  const [stroke, setStroke] = useState<Stroke | null>(null);
  const [settled, setSettled] = useState<Stroke | null>(null);

  const down = (event: PointerEvent) => {
    if (event.button !== 0) return;
    // A second finger is not a goal.
    if (!event.isPrimary) return setStroke(null);
    const at = { x: event.clientX, y: event.clientY };
    event.currentTarget.setPointerCapture(event.pointerId);
    setStroke({ pointer: event.pointerId, start: at, end: at });
  };
  const move = (event: PointerEvent) => {
    if (stroke?.pointer !== event.pointerId) return;
    const end = { x: event.clientX, y: event.clientY };
    setStroke({ ...stroke, end });
    if (root.current !== null && isDrag(stroke.start, end)) onDrag?.(pickOf(stroke.start, end));
  };
  const pickOf = (start: Px, end: Px) => {
    const box = root.current?.getBoundingClientRect() ?? new DOMRect(0, 0, 1, 1);
    return pick(toScene(start, box), isDrag(start, end) ? toScene(end, box) : null);
  };
  const up = (event: PointerEvent) => {
    if (stroke?.pointer !== event.pointerId || root.current === null) return;
    const end = { x: event.clientX, y: event.clientY };
    const drag = isDrag(stroke.start, end);
    setStroke(null);
    setSettled({ ...stroke, end });
    onPick(pickOf(stroke.start, end), {
      at: drag ? end : stroke.start,
      side: drag && end.y < stroke.start.y ? "above" : "below",
    });
  };

  // Until the console has drawn the arrow into the scene, the overlay keeps its own.
  const shown = stroke ?? (waits ? settled : null);
  const box = root.current?.getBoundingClientRect();
  return (
    // biome-ignore lint/a11y/noStaticElementInteractions: a pointer surface; keys have the form
    <div
      ref={root}
      className={classes.overlay}
      data-testid={`${name}-overlay`}
      onPointerDown={down}
      onPointerMove={move}
      onPointerUp={up}
      onPointerCancel={() => setStroke(null)}
      onContextMenu={(event) => event.preventDefault()}
    >
      {shown !== null && box !== undefined && (
        <GestureDrawing
          name={name}
          start={shown.start}
          end={shown.end}
          offset={{ x: box.left, y: box.top }}
        />
      )}
    </div>
  );
}

interface DrawingProps {
  name: string;
  start: Px;
  end: Px;
  offset: Px;
}

function GestureDrawing({ name, start, end, offset }: DrawingProps) {
  const a = { x: start.x - offset.x, y: start.y - offset.y };
  const b = { x: end.x - offset.x, y: end.y - offset.y };
  const drag = isDrag(start, end);
  const head = arrowHead(a, b, 22);
  const base = { x: (head[1].x + head[2].x) / 2, y: (head[1].y + head[2].y) / 2 };
  return (
    <svg className={classes.drawing} aria-hidden="true" data-testid={`${name}-gesture`}>
      <circle cx={a.x} cy={a.y} r={drag ? 8 : 14} className={classes.dot} />
      {drag && (
        <>
          <line x1={a.x} y1={a.y} x2={base.x} y2={base.y} className={classes.halo} />
          <polygon points={head.map((p) => `${p.x},${p.y}`).join(" ")} className={classes.halo} />
          <line x1={a.x} y1={a.y} x2={base.x} y2={base.y} className={classes.shaft} />
          <polygon points={head.map((p) => `${p.x},${p.y}`).join(" ")} className={classes.head} />
        </>
      )}
    </svg>
  );
}
