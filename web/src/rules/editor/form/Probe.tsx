import { createContext, type ReactNode, useContext, useEffect, useRef, useState } from "react";
import type { Condition, LeafReading, ProbeReading, TreePath } from "../../../api/ruleTypes";
import { JsonSocket } from "../../../api/socket";
import { isComplete } from "../../changes/findings";
import { samePath } from "../../model/condition";
import { LeafNow } from "../../parts/LeafNow";
import { VerdictMark, verdictWord } from "../../parts/VerdictMark";
import classes from "./Editor.module.css";

const REST_MS = 200;

/**
 * How the robot would judge a condition that is being written, again and again.
 *
 * @returns the newest reading, or null while there is none: nothing complete to ask about, or no
 *   answer yet.
 */
function useProbe(condition: Condition, clear: Condition | null): ProbeReading | null {
  const [reading, setReading] = useState<ProbeReading | null>(null);
  const socket = useRef<JsonSocket<ProbeReading> | null>(null);
  const wanted = useRef<unknown>(null);
  const asked = JSON.stringify({ condition, clear });
  const complete = isComplete(condition) && (clear === null || isComplete(clear));

  useEffect(() => {
    const own = new JsonSocket<ProbeReading>("/api/rules/probe", {
      message: setReading,
      open: (open) => {
        if (open && wanted.current !== null) own.send(wanted.current);
        if (!open) setReading(null);
      },
    });
    socket.current = own;
    own.open();
    return () => own.close();
  }, []);

  useEffect(() => {
    setReading(null);
    const timer = window.setTimeout(() => {
      wanted.current = complete ? JSON.parse(asked) : { condition: null };
      socket.current?.send(wanted.current);
    }, REST_MS);
    return () => window.clearTimeout(timer);
  }, [asked, complete]);

  return complete ? reading : null;
}

const ProbeContext = createContext<ProbeReading | null>(null);

interface Props {
  condition: Condition;
  clear: Condition | null;
  children: ReactNode;
}

/** Lets the form's small live parts follow the robot without drawing the whole form each time. */
export function ProbeProvider({ condition, clear, children }: Props) {
  return <ProbeContext value={useProbe(condition, clear)}>{children}</ProbeContext>;
}

/** How the robot judges what is being written; null while nobody knows. */
const useReading = (): ProbeReading | null => useContext(ProbeContext);

/** How one leaf is judged right now. */
function useLeafReading(
  root: "event.condition" | "event.clear",
  path: TreePath,
): LeafReading | null {
  const reading = useReading();
  const leaves = root === "event.clear" ? reading?.clear_leaves : reading?.leaves;
  return leaves?.find((leaf) => samePath(leaf.path, path)) ?? null;
}

/** What the robot makes of a whole condition right now. */
export function VerdictLine({ of }: { of: "condition" | "clear" }) {
  const reading = useReading();
  if (reading === null) return null;
  const verdict = of === "clear" ? reading.clear_verdict : reading.verdict;
  return (
    <span className={classes.verdict} data-testid={`probe-${of}`}>
      {reading.error !== "" ? (
        <span className={classes.wrong}>{reading.error}</span>
      ) : (
        <>
          now <VerdictMark verdict={verdict} /> {verdictWord(verdict)}
        </>
      )}
    </span>
  );
}

/** How one leaf of the form is judged right now; nothing while nobody knows. */
export function LiveLeaf(props: { root: "event.condition" | "event.clear"; path: TreePath }) {
  const reading = useLeafReading(props.root, props.path);
  return reading === null ? null : <LeafNow reading={reading} />;
}
