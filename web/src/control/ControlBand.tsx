import { Button } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { useState } from "react";
import { giveControl, keepControl } from "../api/controlClient";
import { Band } from "../ui/Band";
import { sentence } from "./controlText";
import { TakeForm } from "./TakeForm";
import { useControl } from "./useControl";

/** Across the scene: somebody asks for control, has not answered yet, or has taken it. */
export function ControlBand() {
  const control = useControl();
  const [seen, setSeen] = useState("");
  if (control === null) return null;
  const { askedBy, waits, lost, text } = control;
  const told = lost === null ? "" : `${lost.by}: ${lost.reason}`;
  return (
    <>
      {askedBy !== "" && <Asked by={askedBy} />}
      {waits !== null && waits > 0 && (
        <Band tone="notice" testId="control-waits" title="You have asked for control.">
          {text}, and may answer for {Math.ceil(waits)} s.
        </Band>
      )}
      {waits === 0 && (
        <Band
          tone="notice"
          testId="control-unanswered"
          title="Nobody has answered."
          action={<TakeForm />}
        >
          {text}. Take it if you know that nobody is in its way.
        </Band>
      )}
      {lost !== null && told !== seen && (
        <Band
          tone="notice"
          testId="control-lost"
          title={`${sentence(lost.by)} has taken control from you.`}
          action={
            <Button variant="default" size="md" onClick={() => setSeen(told)}>
              I know
            </Button>
          }
        >
          {lost.reason}
        </Band>
      )}
    </>
  );
}

function Asked({ by }: { by: string }) {
  const give = useMutation({ mutationFn: giveControl });
  const keep = useMutation({ mutationFn: keepControl });
  const busy = give.isPending || keep.isPending;
  const problem = give.error ?? keep.error;
  return (
    <Band
      tone="notice"
      testId="control-asked"
      title={`${sentence(by)} asks you for control.`}
      action={
        <>
          <Button
            variant="default"
            size="md"
            disabled={busy}
            onClick={() => keep.mutate()}
            data-testid="control-keep"
          >
            Keep
          </Button>
          <Button
            size="md"
            disabled={busy}
            onClick={() => give.mutate()}
            data-testid="control-give"
          >
            Give
          </Button>
        </>
      }
    >
      {problem === null
        ? "What the robot does now goes on, unless you drive it by hand."
        : `${problem.title} ${problem.remedy}`}
    </Band>
  );
}
