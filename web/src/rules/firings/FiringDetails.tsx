import { Button } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { saveRecording } from "../../api/recordingsClient";
import { rollbackRules } from "../../api/rulesClient";
import type { ActionRecord, Firing, Rule } from "../../api/ruleTypes";
import { Problem } from "../../ui/Problem";
import page from "../../ui/page.module.css";
import { StatusMark } from "../../ui/StatusMark";
import { useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import { clockText, leftText, sentence } from "../model/words";
import { LeafList } from "../parts/LeafList";
import classes from "./Firings.module.css";
import { outcomeText } from "./outcome";

/** Seconds of the flight recorder that are kept with a firing looked at soon after it. */
const KEEP_S = 60;

/** One firing: what made it fire, what was done, and what came of each step. */
export function FiringDetails({ firing, rule }: { firing: Firing; rule: Rule | null }) {
  const nav = useNav();
  const failedStep = firing.actions.some((action) => !action.ok && action.text !== "");
  return (
    <section className={page.section} aria-label="This firing" data-testid="firing-details">
      <p className={classes.head}>
        <strong>{clockText(firing.time)}</strong> {outcomeText(firing, "en")}
        {firing.topic !== null && (
          <>
            , by a message of <code>/{firing.topic}</code>
          </>
        )}
        , rule of{" "}
        <button
          type="button"
          className={page.link}
          onClick={() => nav.go({ at: "history", revision: firing.revision })}
        >
          revision {firing.revision}
        </button>
      </p>
      {firing.text !== "" && <p className={classes.text}>{sentence(firing.text)}</p>}
      {firing.error !== "" && !failedStep && <p className={page.problem}>{firing.error}</p>}
      <LeafList leaves={firing.leaves} of={rule?.event.condition ?? null} then />
      {firing.actions.length > 0 && (
        <ol className={classes.steps}>
          {firing.actions.map((action, index) => (
            // biome-ignore lint/suspicious/noArrayIndexKey: steps of the past keep their place
            <Step key={index} {...action} />
          ))}
        </ol>
      )}
      {firing.message !== null && (
        <details>
          <summary className={page.muted}>The message</summary>
          <pre className={classes.message}>{JSON.stringify(firing.message, null, 1)}</pre>
        </details>
      )}
      {firing.recording !== "" && (
        <p className={page.muted}>
          What was around it is recorded:{" "}
          <button
            type="button"
            className={page.link}
            data-testid="firing-recording"
            onClick={() => nav.go({ at: "recordings", name: recordingName(firing.recording) })}
          >
            {recordingName(firing.recording)}
          </button>
        </p>
      )}
      <FiringActions firing={firing} />
    </section>
  );
}

/** What came of one action. */
function Step({ action, ok, seconds, text, problem = text }: ActionRecord) {
  return (
    <li>
      <StatusMark level={ok ? "healthy" : "failed"} />
      <span>
        {action}: {ok ? "ok" : "failed"} after {leftText(seconds)}
        {text !== "" && (
          <span className={classes.said} data-failed={!ok || undefined}>
            {ok ? text : problem}
          </span>
        )}
      </span>
    </li>
  );
}

/** A recording's name from its path on the robot. */
const recordingName = (path: string): string =>
  (path.split("/").at(-1) ?? path).replace(/\.mcap$/, "");

/** What can be done about it: back to the table before this one, or keep the recording. */
function FiringActions({ firing }: { firing: Firing }) {
  const { view, mayEdit, reload } = useRules();
  const act = useMutation({ mutationFn: (what: () => Promise<string>) => what() });
  if (!mayEdit || view === null) return null;
  const rollBack = async (revision: number | null) => {
    const report = await rollbackRules(
      revision,
      view.revision,
      `after the firing of "${firing.name || firing.rule_id}" at ${clockText(firing.time)}`,
    );
    reload();
    return `Revision ${report.revision} is in force.`;
  };
  const keep = async () => `Kept as ${(await saveRecording(KEEP_S, "")).name}.`;
  return (
    <>
      <div className={page.line}>
        {firing.revision === view.revision ? (
          <Button
            variant="default"
            loading={act.isPending}
            disabled={view.revision <= 1}
            onClick={() => act.mutate(() => rollBack(null))}
            data-testid="firing-rollback"
          >
            Roll back this revision
          </Button>
        ) : (
          <Button
            variant="default"
            loading={act.isPending}
            onClick={() => act.mutate(() => rollBack(firing.revision))}
            data-testid="firing-rollback"
          >
            Roll back to revision {firing.revision}
          </Button>
        )}
        {firing.recording === "" && (
          <Button variant="subtle" loading={act.isPending} onClick={() => act.mutate(keep)}>
            Keep the last minute recorded
          </Button>
        )}
      </div>
      {act.isSuccess && <p className={page.muted}>{act.data}</p>}
      <Problem error={act.error} />
    </>
  );
}
