import { Button } from "@mantine/core";
import { wholeAgeText } from "../../format";
import { useRobot } from "../../state/RobotContext";
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
          title="Safe mode: the recipe's own rules are in force."
          testId="safe-mode"
        >
          Edits of before are kept. Start the stack without safe mode to have them again.
        </Band>
      )}
      {error !== null && (
        <Band
          tone="notice"
          title={error.title}
          testId="rules-error"
          action={
            <Button variant="default" onClick={reload}>
              Try again
            </Button>
          }
        >
          {error.remedy}
        </Band>
      )}
      {view?.merge != null && mayEdit && <RecipeMergeBand merge={view.merge} />}
      {draft.overtaken && nav.place.at !== "conflict" && (
        <Band
          tone="notice"
          title={`Somebody changed the rules: revision ${view?.revision} is in force.`}
          testId="overtaken-band"
          action={
            <Button onClick={() => nav.go({ at: "conflict" })} data-testid="open-conflict">
              Compare
            </Button>
          }
        >
          Your changes began from revision {draft.draft?.base}. Nothing you typed is lost.
        </Band>
      )}
      {!draft.kept && (
        <Band tone="notice" title="This browser cannot keep your changes over a reload.">
          Apply them, or allow the page to store data.
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
      <Band tone="stale" testId="rules-stale" title="No word from the rules.">
        {rules === null ? "Waiting for the console." : "What you see is as it was before."}
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
          ? "No monitor was found: rules cannot be read."
          : `The rules have been silent for ${wholeAgeText(age)}.`
      }
    >
      {rules.age === null
        ? "Start the stack, or wait until it is up."
        : "They may be restarting. What you typed stays."}
    </Band>
  );
}
