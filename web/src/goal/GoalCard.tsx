import { Button, Loader } from "@mantine/core";
import { useLayoutEffect, useRef, useState } from "react";
import type { Goal, GoalCheck } from "../api/types";
import { useControl } from "../control/useControl";
import { distanceText } from "../format";
import { SavePlace } from "../places/SavePlace";
import { useSession } from "../session/SessionContext";
import { useRobot } from "../state/RobotContext";
import { useStop } from "../stop/StopContext";
import { t } from "../texts/text";
import { langOf, told } from "../texts/told";
import classes from "./Goal.module.css";
import { checkText, isUnderWay, placeText } from "./goalText";
import { useCardPlace } from "./useCardPlace";
import type { Draft, GoalTool } from "./useGoalTool";

/** The answer to a pick, where the hand is: what will happen, and Go; or why not, and what else. */
export function GoalCard({ tool, draft }: { tool: GoalTool; draft: Draft }) {
  const goButton = useRef<HTMLButtonElement>(null);
  const [naming, setNaming] = useState(false);
  const { session } = useSession();
  const { state } = useRobot();
  const { drive } = useStop();
  const { anchor, check, error, phase, place: of } = draft;
  const stopped = drive?.stopped === true;
  const drivenBy = drive?.driven_by ?? "";
  const control = useControl();
  const others = control?.whose === "other" ? `${control.text}. ${control.remedy}` : "";
  const held = stopped || drivenBy !== "" || others !== "";
  const { card, place, style } = useCardPlace(
    anchor,
    [phase, check, error, held, naming],
    // The hand is at the list; in the corner beside it the card leaves the way to be seen.
    of === null ? "middle" : "corner",
  );
  const ready = phase !== "checking" && check?.ok === true && error === null;

  useLayoutEffect(() => {
    if (ready && place !== null) goButton.current?.focus({ preventScroll: true });
  }, [ready, place]);

  return (
    <div
      ref={card}
      className={classes.card}
      data-testid="goal-card"
      role="dialog"
      aria-label={t("Goal")}
      style={style}
    >
      <div aria-live="polite">
        {phase === "checking" ? (
          <p className={classes.lead}>
            <Loader size="xs" /> {t("Checking…")}
          </p>
        ) : (
          <Answer
            check={check}
            draft={draft}
            goal={state?.goal ?? null}
            stopped={stopped}
            drivenBy={drivenBy}
            others={others}
          />
        )}
      </div>
      {naming && check !== null && (
        <SavePlace
          pose={{ x: check.x, y: check.y, yaw: check.yaw }}
          onDone={() => setNaming(false)}
        />
      )}
      <div className={classes.actions} hidden={naming}>
        {check?.ok && (
          <Button
            ref={goButton}
            size="md"
            onClick={tool.go}
            loading={phase === "sending"}
            disabled={held}
            data-testid="goal-go"
          >
            {t("Go")}
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
            {t("Go to the nearest reachable point")}
          </Button>
        )}
        <Button size="md" variant="default" onClick={tool.drop} data-testid="goal-cancel">
          {t("Cancel")}
        </Button>
        {check?.ok && of === null && session.role !== "viewer" && (
          <Button
            size="md"
            variant="subtle"
            className={classes.wide}
            onClick={() => setNaming(true)}
            data-testid="goal-save-place"
          >
            {t("Save this place")}
          </Button>
        )}
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
  /** Who else has control, and what there is to do; empty when nobody else has. */
  others: string;
}

function Answer({ check, draft, goal, stopped, drivenBy, others }: AnswerProps) {
  const { cause } = useRobot();
  const { error } = draft;
  const gap =
    check?.nearest && !check.ok
      ? Math.hypot(check.nearest.x - check.x, check.nearest.y - check.y)
      : null;
  return (
    <>
      {error !== null && (
        <p className={classes.problem} lang={langOf(error.title)}>
          {told(error.title)} {told(error.remedy)}
        </p>
      )}
      {draft.place !== null && (
        <p className={classes.detail}>{t("To {name}", { name: draft.place.name })}</p>
      )}
      {check !== null && (error === null || check.ok) && (
        <p
          className={check.ok ? classes.lead : classes.problem}
          lang={check.ok ? undefined : langOf(check.message)}
        >
          {checkText(check)}
        </p>
      )}
      {check?.ok && <p className={classes.detail}>{placeText(check.x, check.y, check.yaw)}</p>}
      {gap !== null && check?.reason !== "above_horizon" && (
        <p className={classes.detail}>
          {t("The nearest reachable point is {distance} from the one you picked.", {
            distance: distanceText(gap),
          })}
        </p>
      )}
      {check?.note && (
        <p className={classes.note} lang={langOf(check.note)}>
          {told(check.note)}
        </p>
      )}
      {check?.ok && !check.heading_used && check.yaw !== null && check.note === "" && (
        <p className={classes.note}>
          {t("The running recipe takes points only: the heading is not used.")}
        </p>
      )}
      {check?.ok && !stopped && cause !== null && !cause.minor && (
        <p className={classes.note}>
          ▲ {cause.text}. {cause.advice}
        </p>
      )}
      {stopped && (
        <p className={classes.note}>{t("The robot is stopped: release the stop first.")}</p>
      )}
      {!stopped && drivenBy !== "" && (
        <p className={classes.note}>
          {t("{drivenBy} drives by hand: the wheel must be given up first.", { drivenBy })}
        </p>
      )}
      {!stopped && drivenBy === "" && others !== "" && <p className={classes.note}>{others}</p>}
      {check?.ok && isUnderWay(goal) && !stopped && (
        <p className={classes.note}>{t("Replaces the goal that the robot is driving to.")}</p>
      )}
    </>
  );
}
