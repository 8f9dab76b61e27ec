import { Button } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { useState } from "react";
import { giveControl, keepControl } from "../api/controlClient";
import { t } from "../texts/text";
import { told } from "../texts/told";
import { Band } from "../ui/Band";
import { TakeForm } from "./TakeForm";
import { useControl } from "./useControl";

/** Across the scene: somebody asks for control, has not answered yet, or has taken it. */
export function ControlBand() {
  const control = useControl();
  const [seen, setSeen] = useState("");
  if (control === null) return null;
  const { askedBy, waits, lost, text } = control;
  const loss = lost === null ? "" : `${lost.by}: ${lost.reason}`;
  return (
    <>
      {askedBy !== "" && <Asked by={askedBy} />}
      {waits !== null && waits > 0 && (
        <Band tone="notice" testId="control-waits" title={t("You have asked for control.")}>
          {t("{text}, and may answer for {left} s.", { text, left: Math.ceil(waits) })}
        </Band>
      )}
      {waits === 0 && (
        <Band
          tone="notice"
          testId="control-unanswered"
          title={t("Nobody has answered.")}
          action={<TakeForm />}
        >
          {t("{text}. Take it if you know that nobody is in its way.", { text })}
        </Band>
      )}
      {lost !== null && loss !== seen && (
        <Band
          tone="notice"
          testId="control-lost"
          title={t("{name} has taken control from you.", { name: lost.by })}
          action={
            <Button variant="default" size="md" onClick={() => setSeen(loss)}>
              {t("I know")}
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
      title={t("{name} asks you for control.", { name: by })}
      action={
        <>
          <Button
            variant="default"
            size="md"
            disabled={busy}
            onClick={() => keep.mutate()}
            data-testid="control-keep"
          >
            {t("Keep")}
          </Button>
          <Button
            size="md"
            disabled={busy}
            onClick={() => give.mutate()}
            data-testid="control-give"
          >
            {t("Give")}
          </Button>
        </>
      }
    >
      {problem === null
        ? t("What the robot does now goes on, unless you drive it by hand.")
        : `${told(problem.title)} ${told(problem.remedy)}`}
    </Band>
  );
}
