import { UnstyledButton } from "@mantine/core";
import { type ReactNode, useEffect, useRef, useState } from "react";
import classes from "./HoldButton.module.css";

interface Props {
  onHeld: () => void;
  children: ReactNode;
  label: string;
  disabled?: boolean;
  "data-testid"?: string;
}

export const HOLD_MS = 1000;

/**
 * Acts after being held for a second, with a pointer or with Enter, and shows the progress.
 * Space is STOP everywhere, here too.
 */
export function HoldButton({ onHeld, children, label, disabled = false, ...rest }: Props) {
  const [holding, setHolding] = useState(false);
  const held = useRef(onHeld);
  useEffect(() => {
    held.current = onHeld;
  });
  useEffect(() => {
    if (!holding) return;
    const timer = window.setTimeout(() => {
      setHolding(false);
      held.current();
    }, HOLD_MS);
    // STOP takes its key before anything in the page sees it: who stops lets nothing go.
    const onKeyDown = (event: KeyboardEvent) => {
      if (event.key === " ") setHolding(false);
    };
    window.addEventListener("keydown", onKeyDown, true);
    return () => {
      window.clearTimeout(timer);
      window.removeEventListener("keydown", onKeyDown, true);
    };
  }, [holding]);

  const start = () => setHolding(!disabled);
  const end = () => setHolding(false);
  return (
    <UnstyledButton
      className={classes.hold}
      data-holding={holding || undefined}
      data-testid={rest["data-testid"]}
      aria-label={label}
      disabled={disabled}
      style={{ "--hold-ms": `${HOLD_MS}ms` }}
      onPointerDown={(event) => {
        if (event.button !== 0) return;
        start();
      }}
      onPointerUp={end}
      onPointerLeave={end}
      onPointerCancel={end}
      onContextMenu={(event) => event.preventDefault()}
      onKeyDown={(event) => {
        if (event.key === "Enter" && !event.repeat) start();
      }}
      onKeyUp={(event) => {
        if (event.key === "Enter") end();
      }}
      onBlur={end}
    >
      <span className={classes.fill} aria-hidden />
      <span className={classes.text}>{children}</span>
    </UnstyledButton>
  );
}
