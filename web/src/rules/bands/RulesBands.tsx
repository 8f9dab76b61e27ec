import { Button } from "@mantine/core";
import { wholeAgeText } from "../../format";
import { useRobot } from "../../state/RobotContext";
import { t } from "../../texts/text";
import { told } from "../../texts/told";
import { Band } from "../../ui/Band";
import { useLive, useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import { ProbationBand } from "./ProbationBand";
import { RecipeMergeBand } from "./RecipeMergeBand";

/** The monitor speaks at least this often while somebody listens. */
const SILENT_S = 3;

/** What one must know before reading or changing rules. */
export function RulesBands() {
  const { view, error, draft, reload, mayEdit } = useRules();
  const nav = useNav();
  return (
    <>
      <SilenceBand />
      <ProbationBand />
      {view?.safe_mode && (
        <Band
          tone="notice"
          title={t("Safe mode: the recipe's own rules are in force.")}
          testId="safe-mode"
        >
          {t("Edits of before are kept. Start the stack without safe mode to have them again.")}
        </Band>
      )}
      {error !== null && (
        <Band
          tone="notice"
          title={told(error.title)}
          testId="rules-error"
          action={
            <Button variant="default" onClick={reload}>
              {t("Try again")}
            </Button>
          }
        >
          {told(error.remedy)}
        </Band>
      )}
      {view?.merge != null && mayEdit && <RecipeMergeBand merge={view.merge} />}
      {draft.overtaken && nav.place.at !== "conflict" && (
        <Band
          tone="notice"
          title={t("Somebody changed the rules: revision {revision} is in force.", {
            revision: view?.revision ?? 0,
          })}
          testId="overtaken-band"
          action={
            <Button onClick={() => nav.go({ at: "conflict" })} data-testid="open-conflict">
              {t("Compare")}
            </Button>
          }
        >
          {t("Your changes began from revision {base}. Nothing you typed is lost.", {
            base: draft.draft?.base ?? 0,
          })}
        </Band>
      )}
      {!draft.kept && (
        <Band tone="notice" title={t("This browser cannot keep your changes over a reload.")}>
          {t("Apply them, or allow the page to store data.")}
        </Band>
      )}
    </>
  );
}

function SilenceBand() {
  const { rules, connected, receivedAt } = useLive();
  const { frozen } = useRobot(); // its clock also makes this one count
  if (frozen || !connected || rules === null) {
    return (
      <Band tone="stale" testId="rules-stale" title={t("No word from the rules.")}>
        {rules === null ? t("Waiting for the console.") : t("What you see is as it was before.")}
      </Band>
    );
  }
  const age = (rules.age ?? 0) + (performance.now() - receivedAt) / 1000;
  if (rules.available && age < SILENT_S) return null;
  return (
    <Band
      tone="stale"
      testId="rules-stale"
      title={
        rules.age === null
          ? t("No monitor was found: rules cannot be read.")
          : t("The rules have been silent for {age}.", { age: wholeAgeText(age) })
      }
    >
      {rules.age === null
        ? t("Start the stack, or wait until it is up.")
        : t("They may be restarting. What you typed stays.")}
    </Band>
  );
}
