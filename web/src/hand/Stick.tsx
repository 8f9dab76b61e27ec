import { UnstyledButton } from "@mantine/core";
import { type PointerEvent, useEffect, useRef, useState } from "react";
import { t } from "../texts/text";
import classes from "./Hand.module.css";
import type { HandLoop } from "./handLoop";
import { NOTHING, stickPush } from "./push";

const MIDDLE = { x: 0, y: 0 };

/** A stick for the thumb: it drives while it is held, and springs back. */
export function Stick({ loop }: { loop: HandLoop }) {
  const pointer = useRef<number | null>(null);
  const [knob, setKnob] = useState(MIDDLE);

  const end = () => {
    if (pointer.current === null) return;
    pointer.current = null;
    setKnob(MIDDLE);
    loop.moveStick(NOTHING);
  };
  useEffect(
    () =>
      loop.onLetGo(() => {
        pointer.current = null;
        setKnob(MIDDLE);
      }),
    [loop],
  );

  const move = (event: PointerEvent<HTMLElement>) => {
    if (event.pointerId !== pointer.current) return;
    const box = event.currentTarget.getBoundingClientRect();
    const radius = box.width / 2;
    const x = (event.clientX - box.left - radius) / radius;
    const y = (event.clientY - box.top - radius) / radius;
    const reach = Math.max(1, Math.hypot(x, y));
    setKnob({ x: x / reach, y: y / reach });
    loop.moveStick(stickPush(x, y));
  };
  return (
    <UnstyledButton
      className={classes.stick}
      data-testid="hand-stick"
      data-held={knob !== MIDDLE || undefined}
      aria-label={t(
        "Stick: hold it, and push to where the robot is to go. W, A, S, D and the arrows do the same.",
      )}
      onPointerDown={(event) => {
        if (event.button !== 0 || pointer.current !== null) return;
        pointer.current = event.pointerId;
        event.currentTarget.setPointerCapture(event.pointerId);
        move(event);
      }}
      onPointerMove={move}
      onPointerUp={end}
      onPointerCancel={end}
      onLostPointerCapture={end}
      onContextMenu={(event) => event.preventDefault()}
    >
      <span
        className={classes.knob}
        style={{ transform: `translate(${62 * knob.x}%, ${62 * knob.y}%)` }}
        aria-hidden
      />
    </UnstyledButton>
  );
}
