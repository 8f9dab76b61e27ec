import { Button } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { useState } from "react";
import { confirmRules, rollbackRules } from "../../api/rulesClient";
import { t } from "../../texts/text";
import { told } from "../../texts/told";
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
  const [seen, see] = useSeen();
  const send = useMutation({
    mutationFn: (what: () => Promise<unknown>) => what(),
    onSuccess: reload,
  });
  if (probation === null || probation.left <= 0) {
    // Where the rules are open, a band of its own says more of these two.
    const elsewhere = open && (view?.merge != null || view?.safe_mode === true);
    const notice = elsewhere ? "" : (probation?.notice ?? "");
    return notice === "" || notice === seen ? null : (
      <Band
        tone="notice"
        title={sentence(told(notice))}
        testId="rules-notice"
        action={
          <Button variant="default" onClick={() => see(notice)} data-testid="notice-seen">
            {t("Understood")}
          </Button>
        }
      />
    );
  }
  const { revision, confirmed, left } = probation;
  return (
    <Band
      tone="notice"
      testId="probation-band"
      title={t("Revision {revision} is on probation: {left} left.", {
        revision,
        left: leftText(left),
      })}
      action={
        mayEdit ? (
          <>
            <Button
              variant="default"
              loading={send.isPending}
              data-testid="take-back"
              onClick={() => send.mutate(() => rollbackRules(confirmed, revision, "taken back"))}
            >
              {t("Take it back")}
            </Button>
            <Button
              loading={send.isPending}
              data-testid="keep-it"
              onClick={() => send.mutate(() => confirmRules(revision))}
            >
              {t("Keep it")}
            </Button>
          </>
        ) : undefined
      }
    >
      {send.isError
        ? `${send.error.title} ${send.error.remedy}`
        : t("Unless it is kept, the robot goes back to revision {confirmed} by itself.", {
            confirmed,
          })}
    </Band>
  );
}
