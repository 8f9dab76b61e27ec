import { Button } from "@mantine/core";
import { useState } from "react";
import { releaseStop } from "../api/client";
import { ApiError, asApiError } from "../api/errors";
import { useSession } from "../session/SessionContext";
import { Band } from "../ui/Band";
import { HoldButton } from "../ui/controls/HoldButton";
import { useStop } from "./StopContext";

/** Across the scene while the robot is stopped, or while nobody knows whether it is. */
export function StopBand() {
  const { stop, drive, dismiss } = useStop();
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
  if (!latched && stop.phase !== "unconfirmed") return null;
  const who = drive?.stopped_by ? `Stopped by ${drive.stopped_by}` : "Stopped";
  const why = drive?.reason ? `: ${drive.reason}` : "";
  return (
    <>
      {stop.phase === "unconfirmed" && (
        <Band tone="alarm" title="Stop is not confirmed" testId="stop-unconfirmed">
          {stop.problem} {stop.remedy}
          {!stop.latched && (
            <Button variant="default" size="compact-md" onClick={dismiss} ml="sm">
              I have looked
            </Button>
          )}
        </Band>
      )}
      {latched && (
        <Band
          tone="stopped"
          title={`${who}${why}`}
          testId="stop-band"
          action={
            session.role === "viewer" ? undefined : (
              <HoldButton
                data-testid="release-button"
                label="Release the stop: press and hold for one second, or hold Enter"
                onHeld={release}
              >
                Hold to release
              </HoldButton>
            )
          }
        >
          {refusal !== null
            ? `${refusal.title} ${refusal.remedy}`
            : session.role === "viewer"
              ? "An operator can release it."
              : "The robot stays where it is until a person releases it; then send it a new goal."}
        </Band>
      )}
    </>
  );
}
