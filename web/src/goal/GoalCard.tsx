import { Button, Loader } from "@mantine/core";
import { useLayoutEffect, useRef, useState } from "react";
import type { Goal, GoalCheck } from "../api/types";
import { distanceText } from "../format";
import { useRobot } from "../state/RobotContext";
import { useStop } from "../stop/StopContext";
import classes from "./Goal.module.css";
import { type Px, placeCard } from "./gesture";
import { checkText, isUnderWay, placeText } from "./goalText";
import type { Draft, GoalTool } from "./useGoalTool";

/** The answer to a pick, where the hand is: what will happen, and Go; or why not, and what else. */
export function GoalCard({ tool, draft }: { tool: GoalTool; draft: Draft }) {
  const card = useRef<HTMLDivElement>(null);
  const goButton = useRef<HTMLButtonElement>(null);
  const [place, setPlace] = useState<Px | null>(null);
  const { state } = useRobot();
  const { drive } = useStop();
  const { anchor, check, error, phase } = draft;
  const stopped = drive?.stopped === true;
  const drivenBy = drive?.driven_by ?? "";
  const held = stopped || drivenBy !== "";
  const ready = phase !== "checking" && check?.ok === true && error === null;

  // biome-ignore lint/correctness/useExhaustiveDependencies: its size follows what it says
  useLayoutEffect(() => {
    const parent = card.current?.offsetParent;
    if (card.current === null || !(parent instanceof HTMLElement)) return;
    const box = parent.getBoundingClientRect();
    const size = { width: card.current.offsetWidth, height: card.current.offsetHeight };
    const middle = { x: box.left + box.width / 2, y: box.top + box.height / 3 };
    const { x, y } = placeCard(anchor?.at ?? middle, size, box, anchor?.side);
    setPlace({ x: x - box.left, y: y - box.top });
  }, [anchor, phase, check, error, held]);

  useLayoutEffect(() => {
    if (ready && place !== null) goButton.current?.focus({ preventScroll: true });
  }, [ready, place]);

  return (
    <div
      ref={card}
      className={classes.card}
      data-testid="goal-card"
      role="dialog"
      aria-label="Goal"
      style={place === null ? { visibility: "hidden" } : { left: place.x, top: place.y }}
    >
      <div aria-live="polite">
        {phase === "checking" ? (
          <p className={classes.lead}>
            <Loader size="xs" /> Checking…
          </p>
        ) : (
          <Answer
            check={check}
            draft={draft}
            goal={state?.goal ?? null}
            stopped={stopped}
            drivenBy={drivenBy}
          />
        )}
      </div>
      <div className={classes.actions}>
        {check?.ok && (
          <Button
            ref={goButton}
            size="md"
            onClick={tool.go}
            loading={phase === "sending"}
            disabled={held}
            data-testid="goal-go"
          >
            Go
          </Button>
        )}
        {check?.nearest && !check.ok && (
          <Button
            size="md"
            className={classes.wide}
            px="xs"
            onClick={tool.goNearest}
            loading={phase === "sending"}
            disabled={held}
            data-testid="goal-nearest"
          >
            Go to the nearest reachable point
          </Button>
        )}
        <Button size="md" variant="default" onClick={tool.drop} data-testid="goal-cancel">
          Cancel
        </Button>
      </div>
    </div>
  );
}

interface AnswerProps {
  check: GoalCheck | null;
  draft: Draft;
  goal: Goal | null;
  stopped: boolean;
  drivenBy: string;
}

function Answer({ check, draft, goal, stopped, drivenBy }: AnswerProps) {
  const { error } = draft;
  const gap =
    check?.nearest && !check.ok
      ? Math.hypot(check.nearest.x - check.x, check.nearest.y - check.y)
      : null;
  return (
    <>
      {error !== null && (
        <p className={classes.problem}>
          {error.title} {error.remedy}
        </p>
      )}
      {check !== null && (error === null || check.ok) && (
        <p className={check.ok ? classes.lead : classes.problem}>{checkText(check)}</p>
      )}
      {check?.ok && <p className={classes.detail}>{placeText(check.x, check.y, check.yaw)}</p>}
      {gap !== null && check?.reason !== "above_horizon" && (
        <p className={classes.detail}>
          The nearest reachable point is {distanceText(gap)} from the one you picked.
        </p>
      )}
      {check?.note && <p className={classes.note}>{check.note}</p>}
      {check?.ok && !check.heading_used && check.yaw !== null && check.note === "" && (
        <p className={classes.note}>
          The running recipe takes points only: the heading is not used.
        </p>
      )}
      {stopped && <p className={classes.note}>The robot is stopped: release the stop first.</p>}
      {!stopped && drivenBy !== "" && (
        <p className={classes.note}>{drivenBy} drives by hand: the wheel must be given up first.</p>
      )}
      {check?.ok && isUnderWay(goal) && !stopped && (
        <p className={classes.note}>Replaces the goal that the robot is driving to.</p>
      )}
    </>
  );
}
