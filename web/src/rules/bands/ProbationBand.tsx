import { Button } from "@mantine/core";
import { useState } from "react";
import { type ApiError, asApiError } from "../../api/errors";
import { confirmRules, rollbackRules } from "../../api/rulesClient";
import { Band } from "../../ui/Band";
import { useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import { leftText, sentence } from "../model/words";
import { useProbation } from "./useProbation";

const SEEN = "kompass.rules.notice";

/** The notice that was read already in this browser's tab, and how to say so of another. */
function useSeen(): [string | null, (notice: string) => void] {
  const [seen, setSeen] = useState(() => sessionStorage.getItem(SEEN));
  const see = (notice: string) => {
    sessionStorage.setItem(SEEN, notice);
    setSeen(notice);
  };
  return [seen, see];
}

/** A table on probation: how long it has, and whether to keep it. */
export function ProbationBand() {
  const { view, mayEdit, reload } = useRules();
  const { open } = useNav();
  const probation = useProbation();
  const [busy, setBusy] = useState(false);
  const [seen, see] = useSeen();
  const [error, setError] = useState<ApiError | null>(null);
  if (probation === null || probation.left <= 0) {
    // Where the rules are open, a band of its own says more of these two.
    const elsewhere = open && (view?.merge != null || view?.safe_mode === true);
    const notice = elsewhere ? "" : (probation?.notice ?? "");
    return notice === "" || notice === seen ? null : (
      <Band
        tone="notice"
        title={sentence(notice)}
        testId="rules-notice"
        action={
          <Button variant="default" onClick={() => see(notice)} data-testid="notice-seen">
            Understood
          </Button>
        }
      />
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
