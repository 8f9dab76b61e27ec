import { type ReactNode, useLayoutEffect, useRef } from "react";
import classes from "./Goal.module.css";

/** What can be done while a tool of the scene is on, at its lower edge. As `--bar` the scene knows
 * how high that is: what would be covered by it keeps clear. */
export function GestureBar({ testId, children }: { testId?: string; children: ReactNode }) {
  const bar = useRef<HTMLDivElement>(null);
  useLayoutEffect(() => {
    const element = bar.current;
    const scene = element?.parentElement;
    if (element === null || scene == null) return;
    const observer = new ResizeObserver(() =>
      scene.style.setProperty("--bar", `${element.offsetHeight + 12}px`),
    );
    observer.observe(element);
    return () => {
      observer.disconnect();
      scene.style.removeProperty("--bar");
    };
  }, []);
  return (
    <div ref={bar} className={classes.bar} data-testid={testId}>
      {children}
    </div>
  );
}
