import { Button } from "@mantine/core";
import { useState } from "react";
import { type ApiError, asApiError } from "../../api/errors";
import { confirmRules, rollbackRules } from "../../api/rulesClient";
import { Band } from "../../frame/Band";
import { leftText } from "../model/words";
import { useRules } from "./RulesContext";
import { useProbation } from "./useProbation";

/** A table on probation: how long it has, and whether to keep it. */
export function ProbationBand() {
  const { mayEdit, reload } = useRules();
  const probation = useProbation();
  const [busy, setBusy] = useState(false);
  const [error, setError] = useState<ApiError | null>(null);
  if (probation === null || probation.left <= 0) {
    return probation === null || probation.notice === "" ? null : (
      <Band tone="notice" title={probation.notice} testId="rules-notice" />
    );
  }
  const { revision, confirmed, left } = probation;
  const send = (what: Promise<unknown>) => {
    setBusy(true);
    setError(null);
    what
      .then(reload, (failure: unknown) => setError(asApiError(failure)))
      .finally(() => setBusy(false));
  };
  return (
    <Band
      tone="notice"
      testId="probation-band"
      title={`Revision ${revision} is on probation: ${leftText(left)} left.`}
      action={
        mayEdit ? (
          <>
            <Button
              variant="default"
              loading={busy}
              data-testid="take-back"
              onClick={() => send(rollbackRules(confirmed, revision, "taken back"))}
            >
              Take it back
            </Button>
            <Button
              loading={busy}
              data-testid="keep-it"
              onClick={() => send(confirmRules(revision))}
            >
              Keep it
            </Button>
          </>
        ) : undefined
      }
    >
      {error !== null
        ? `${error.title} ${error.remedy}`
        : `Unless it is kept, the robot goes back to revision ${confirmed} by itself.`}
    </Band>
  );
}
