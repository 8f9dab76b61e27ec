import { type PointerEvent, useRef, useState } from "react";
import classes from "./Goal.module.css";
import { arrowHead, isDrag, type Px, toScene } from "./gesture";
import type { GoalTool } from "./useGoalTool";

interface Stroke {
  pointer: number;
  start: Px;
  end: Px;
}

/**
 * Lies over the scene while the goal tool is on. Draws the gesture itself, so that the arrow is
 * under the pointer in the same frame, whatever the network does.
 */
export function GoalOverlay({ tool, view }: { tool: GoalTool; view: string }) {
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
    setStroke({ ...stroke, end: { x: event.clientX, y: event.clientY } });
  };
  const up = (event: PointerEvent) => {
    if (stroke?.pointer !== event.pointerId || root.current === null) return;
    const end = { x: event.clientX, y: event.clientY };
    const box = root.current.getBoundingClientRect();
    const drag = isDrag(stroke.start, end);
    setStroke(null);
    setSettled({ ...stroke, end });
    tool.check(
      { view, start: toScene(stroke.start, box), end: drag ? toScene(end, box) : null },
      { at: drag ? end : stroke.start, side: drag && end.y < stroke.start.y ? "above" : "below" },
    );
  };

  // Until the console has drawn the arrow into the scene, the overlay keeps its own.
  const shown = stroke ?? (tool.draft?.phase === "checking" ? settled : null);
  const box = root.current?.getBoundingClientRect();
  return (
    // biome-ignore lint/a11y/noStaticElementInteractions: a pointer surface; keys have the form
    <div
      ref={root}
      className={classes.overlay}
      data-testid="goal-overlay"
      onPointerDown={down}
      onPointerMove={move}
      onPointerUp={up}
      onPointerCancel={() => setStroke(null)}
      onContextMenu={(event) => event.preventDefault()}
    >
      {shown !== null && box !== undefined && (
        <GestureDrawing start={shown.start} end={shown.end} offset={{ x: box.left, y: box.top }} />
      )}
    </div>
  );
}

function GestureDrawing({ start, end, offset }: { start: Px; end: Px; offset: Px }) {
  const a = { x: start.x - offset.x, y: start.y - offset.y };
  const b = { x: end.x - offset.x, y: end.y - offset.y };
  const drag = isDrag(start, end);
  const head = arrowHead(a, b, 22);
  const base = { x: (head[1].x + head[2].x) / 2, y: (head[1].y + head[2].y) / 2 };
  return (
    <svg className={classes.drawing} aria-hidden="true" data-testid="goal-gesture">
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
