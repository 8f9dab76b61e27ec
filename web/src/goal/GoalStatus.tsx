import { Button, CloseButton } from "@mantine/core";
import { useState } from "react";
import { cancelGoal } from "../api/client";
import { type ApiError, asApiError } from "../api/errors";
import { useSession } from "../session/SessionContext";
import { useRobot } from "../state/RobotContext";
import { useStop } from "../stop/StopContext";
import classes from "./Goal.module.css";
import { goalLine, isUnderWay, limitText, placeText } from "./goalText";

/** The goal that was sent, until it ends and a little after. */
export function GoalStatus() {
  const { state, frozen } = useRobot();
  const { drive } = useStop();
  const { session } = useSession();
  const [dismissed, setDismissed] = useState<string | null>(null);
  const [failure, setFailure] = useState<ApiError | null>(null);
  const goal = state?.goal ?? null;
  if (goal === null || goal.id === dismissed) return null;

  const line = goalLine(goal, drive);
  const limit = isUnderWay(goal) ? limitText(drive) : null;
  const cancel = () => {
    setFailure(null);
    cancelGoal().catch((error: unknown) => setFailure(asApiError(error)));
  };
  return (
    <section
      className={classes.status}
      data-testid="goal-status"
      data-phase={goal.phase}
      data-tone={line.tone}
      data-under-way={isUnderWay(goal) || undefined}
      data-stale={frozen || undefined}
      aria-label="Goal"
    >
      <div className={classes.statusText} role="status">
        <strong>{line.text}</strong>
        {line.more !== "" && <span className={classes.detail}>{line.more}</span>}
        {limit !== null && <span className={classes.limit}>▲ {limit}</span>}
        {failure !== null && (
          <span className={classes.problem}>
            {failure.title} {failure.remedy}
          </span>
        )}
        <span className={classes.place}>
          {placeText(goal.x, goal.y, goal.yaw)}
          {goal.sent_by !== "" && ` · by ${goal.sent_by}`}
        </span>
      </div>
      {isUnderWay(goal) ? (
        session.role !== "viewer" && (
          <Button
            size="md"
            variant="default"
            className={classes.cancel}
            onClick={cancel}
            data-testid="goal-cancel-sent"
          >
            Cancel goal
          </Button>
        )
      ) : (
        <CloseButton
          size="lg"
          aria-label="Hide this goal"
          onClick={() => {
            setFailure(null);
            setDismissed(goal.id);
          }}
        />
      )}
    </section>
  );
}
