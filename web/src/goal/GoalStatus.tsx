import { Button, CloseButton } from "@mantine/core";
import { useState } from "react";
import { cancelGoal, sendGoal } from "../api/client";
import { type ApiError, asApiError } from "../api/errors";
import { tellsGoal } from "../missions/missionText";
import { placeAt } from "../places/placeText";
import { usePlaces } from "../places/usePlaces";
import { useSession } from "../session/SessionContext";
import { useNow, useRobot } from "../state/RobotContext";
import { useStop } from "../stop/StopContext";
import { t } from "../texts/text";
import { langOf, told } from "../texts/told";
import classes from "./Goal.module.css";
import { endText, goalLine, isUnderWay, limitText, placeText } from "./goalText";

/** What ended so long (s) before this page was opened is no news to who opened it. */
const OLD_NEWS_S = 60;

/** The goal that was sent, and how it ended; with this page's session that is gone. */
export function GoalStatus() {
  const { state, elapsed, frozen, cause } = useRobot();
  const now = useNow();
  const [opened] = useState(() => performance.now());
  const { drive } = useStop();
  const { session } = useSession();
  const [dismissed, setDismissed] = useState<string | null>(null);
  const [failure, setFailure] = useState<ApiError | null>(null);
  const { list } = usePlaces();
  const goal = state?.goal ?? null;
  const ended = goal?.ended == null ? null : goal.ended + elapsed;
  const before = ended === null ? 0 : ended - (performance.now() - opened) / 1000;
  if (goal === null || goal.id === dismissed || before > OLD_NEWS_S) return null;
  if (tellsGoal(state?.missions.run ?? null, goal.sent_by)) return null;

  const line = goalLine(goal, drive, cause);
  const limit = isUnderWay(goal) ? limitText(drive) : null;
  const place = placeAt(list?.places ?? [], goal);
  const again = () => {
    setFailure(null);
    const { x, y, yaw } = goal;
    sendGoal({ x, y, yaw }).catch((error: unknown) => setFailure(asApiError(error)));
  };
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
      aria-label={t("Goal")}
    >
      <div className={classes.statusText} role="status">
        {/* Why it does not get on is read before how far it would be. */}
        {goal.hindrance !== "" && (
          <strong className={classes.limit} lang={langOf(goal.hindrance)}>
            ▲ {told(goal.hindrance)}
          </strong>
        )}
        <strong lang={goal.phase === "failed" ? langOf(goal.message) : undefined}>
          {line.text}
        </strong>
        {line.more !== "" && <span className={classes.detail}>{line.more}</span>}
        {limit !== null && <span className={classes.limit}>▲ {limit}</span>}
        {failure !== null && (
          <span className={classes.problem} lang={langOf(failure.title)}>
            {told(failure.title)} {told(failure.remedy)}
          </span>
        )}
        <span className={classes.place}>
          {ended !== null && `${endText(ended, now)} · `}
          {place !== null && `${place.name} · `}
          {placeText(goal.x, goal.y, goal.yaw)}
          {goal.sent_by !== "" && ` · ${t("by {by}", { by: told(goal.sent_by) })}`}
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
            {t("Cancel goal")}
          </Button>
        )
      ) : (
        <>
          <CloseButton
            size="lg"
            aria-label={t("Hide this goal")}
            onClick={() => {
              setFailure(null);
              setDismissed(goal.id);
            }}
          />
          {goal.phase !== "arrived" && session.role !== "viewer" && (
            <Button
              size="md"
              variant="default"
              className={classes.cancel}
              disabled={drive?.stopped === true}
              onClick={again}
              data-testid="goal-again"
            >
              {t("Send again")}
            </Button>
          )}
        </>
      )}
    </section>
  );
}
