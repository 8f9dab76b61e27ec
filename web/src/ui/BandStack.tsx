import { UnstyledButton } from "@mantine/core";
import { useMediaQuery } from "@mantine/hooks";
import { type ReactNode, useEffect, useRef, useState } from "react";
import { t } from "../texts/text";
import classes from "./Band.module.css";

/** px; of a scene lower than this a message leaves room to see the robot. */
const LOW = 320;

/** Messages across the scene, the gravest first: what there is no room for waits behind a button. */
export function BandStack({ children }: { children: ReactNode }) {
  const list = useRef<HTMLDivElement>(null);
  const [count, setCount] = useState(0);
  const [open, setOpen] = useState(false);
  const roomy = useMediaQuery("(min-width: 1101px)", true, { getInitialValueInEffect: false });
  const small = useMediaQuery("(max-width: 560px) and (max-height: 700px)", false, {
    getInitialValueInEffect: false,
  });
  const [low, setLow] = useState(false);
  const room = roomy ? 3 : small || low ? 1 : 2;
  useEffect(() => {
    const element = list.current;
    if (element === null) return;
    const look = () => setCount(element.childElementCount);
    const observer = new MutationObserver(look);
    observer.observe(element, { childList: true });
    look();
    return () => observer.disconnect();
  }, []);
  useEffect(() => {
    const scene = list.current?.closest("main");
    if (scene == null) return;
    const observer = new ResizeObserver(() => setLow(scene.clientHeight < LOW));
    observer.observe(scene);
    return () => observer.disconnect();
  }, []);
  const more = Math.max(0, count - room);
  return (
    <div className={classes.stack}>
      <div
        ref={list}
        className={classes.list}
        id="bands"
        data-low={low || undefined}
        data-room={open || more === 0 ? undefined : room}
      >
        {children}
      </div>
      {more > 0 && (
        <UnstyledButton
          className={classes.others}
          aria-expanded={open}
          aria-controls="bands"
          data-testid="bands-more"
          onClick={() => setOpen(!open)}
        >
          {open
            ? t("Fewer messages")
            : t("{more, plural, one {One more message} other {# more messages}}", { more })}
        </UnstyledButton>
      )}
    </div>
  );
}
