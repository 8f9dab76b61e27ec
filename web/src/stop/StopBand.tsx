import { Button } from "@mantine/core";
import { type ReactNode, useState } from "react";
import { releaseStop } from "../api/client";
import { ApiError, asApiError } from "../api/errors";
import type { Drive } from "../api/types";
import { ageText } from "../format";
import { useSession } from "../session/SessionContext";
import { useRobot } from "../state/RobotContext";
import { t } from "../texts/text";
import { told } from "../texts/told";
import { Band } from "../ui/Band";
import { HoldButton } from "../ui/controls/HoldButton";
import { useStop } from "./StopContext";

/**
 * Across the scene while the robot is stopped, or while nobody knows whether it is: a robot that was
 * stopped when it was last heard of is told of with the age of that.
 *
 * @param why a button that leads to why it was stopped
 * @param brief what is known to who sees it everywhere is left out, for there is little room
 */
export function StopBand({ why, brief = false }: { why: ReactNode; brief?: boolean }) {
  const { stop, drive, dismiss } = useStop();
  const { state, elapsed } = useRobot();
  const { session } = useSession();
  const [refusal, setRefusal] = useState<ApiError | null>(null);

  const release = () => {
    setRefusal(null);
    releaseStop().then(
      (answer) => {
        if (!answer.accepted) setRefusal(new ApiError(200, answer.message, ""));
      },
      (error: unknown) => setRefusal(asApiError(error)),
    );
  };

  const latched = drive?.stopped === true;
  const last = drive === null ? (state?.drive ?? null) : null;
  const was = last?.stopped ? last : null;
  if (!latched && was === null && stop.phase !== "unconfirmed") return null;
  return (
    <>
      {stop.phase === "unconfirmed" && (
        <Band tone="alarm" title={t("Stop is not confirmed")} testId="stop-unconfirmed">
          {told(stop.problem)} {told(stop.remedy)}
          {!stop.latched && (
            <Button variant="default" size="compact-md" onClick={dismiss} ml="sm">
              {t("I have looked")}
            </Button>
          )}
        </Band>
      )}
      {latched && (
        <Band
          tone="stopped"
          title={stoppedText(drive)}
          testId="stop-band"
          action={
            <>
              {why}
              {session.role !== "viewer" && (
                <HoldButton
                  data-testid="release-button"
                  label={t("Hold to release the stop: press for one second, or hold Enter")}
                  onHeld={release}
                >
                  {t("Hold to release")}
                </HoldButton>
              )}
            </>
          }
        >
          {refusal !== null
            ? `${told(refusal.title)} ${told(refusal.remedy)}`
            : session.role === "viewer"
              ? t("An operator can release it.")
              : brief
                ? null
                : state?.missions.run?.phase === "paused"
                  ? t(
                      "The robot stays where it is until a person releases it; then resume the mission.",
                    )
                  : t(
                      "The robot stays where it is until a person releases it; then send it a new goal.",
                    )}
        </Band>
      )}
      {was !== null && (
        <Band tone="stale" title={wasStoppedText(was)} testId="stop-band-stale">
          {t("Last heard {age} ago; it stays so until somebody releases it.", {
            age: ageText(was.age + elapsed),
          })}
        </Band>
      )}
    </>
  );
}

function stoppedText({ stopped_by: by, reason }: Drive): string {
  const text = by === "" ? t("Stopped") : t("Stopped by {by}", { by: told(by) });
  return reason === "" ? text : `${text}: ${told(reason)}`;
}

function wasStoppedText({ stopped_by: by, reason }: Drive): string {
  const text = by === "" ? t("Was stopped") : t("Was stopped by {by}", { by: told(by) });
  return reason === "" ? text : `${text}: ${told(reason)}`;
}
