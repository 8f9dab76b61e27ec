import { Button } from "@mantine/core";
import { useAsked } from "../../api/queries";
import { explainRule } from "../../api/rulesClient";
import type { Explanation, Firing } from "../../api/ruleTypes";
import { useNow } from "../../state/RobotContext";
import { Problem } from "../../ui/Problem";
import page from "../../ui/page.module.css";
import { ruleOf } from "../changes/draft";
import { useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import { FiringDetails } from "../firings/FiringDetails";
import { actionText } from "../model/actions";
import { conditionText } from "../model/condition";
import { plainAction, plainCondition } from "../model/plain";
import { useNames } from "../model/useNames";
import { ruleName, sentence, whenText } from "../model/words";
import { InWords } from "../parts/InWords";
import { LeafList } from "../parts/LeafList";
import { PageTitle } from "../parts/PageTitle";
import { UsedUp } from "../parts/UsedUp";
import classes from "./Why.module.css";

/** While the page is open it is asked again: an explanation is of a moment. */
const AGAIN_MS = 1000;

/** Why a rule fires or does not, right now; or why it did. */
export function WhyPage({ id, firing }: { id: string; firing: Firing | null }) {
  const { view } = useRules();
  const nav = useNav();
  const run = firing?.kind === "firing" || firing?.kind === "shadow" ? firing : null;
  const of = run && { run_id: run.run_id, epoch: run.epoch };
  const { data: found, error } = useAsked({
    key: ["explain", id, of],
    ask: (signal) => explainRule(id, of, signal),
    again: AGAIN_MS,
  });

  const rule = view === null ? null : ruleOf(view.table, id);
  const gone = view !== null && rule === null;
  const name = firing?.name || (rule === null ? id : ruleName(rule));
  return (
    <div className={page.page} data-testid="why">
      <PageTitle title={name} back="Back" onBack={nav.back} />
      {gone && (
        <p className={page.note} data-testid="rule-gone">
          This rule is no longer in the table in force.
        </p>
      )}
      <Problem error={gone ? null : error} />
      {firing !== null && (
        <FiringDetails firing={found?.firing ?? firing} rule={found?.rule ?? null} />
      )}
      {found === null && error === null && firing === null && (
        <p className={page.muted}>Asking the robot…</p>
      )}
      {found !== null &&
        (run === null ? <Now found={found} /> : <Then found={found} gone={gone} />)}
    </div>
  );
}

function Now({ found }: { found: Explanation }) {
  const nav = useNav();
  const now = useNow();
  const { rule, status, gates, leaves, clear_leaves, near_misses } = found;
  const names = useNames();
  const told = gates.filter(({ kind }) => kind !== "false" && kind !== "disabled");
  return (
    <>
      <p className={classes.answer} data-testid="why-answer">
        {gates.length === 0
          ? sentence(found.text)
          : `It does not fire now: ${gates.map(gateText).join("; ")}.`}
      </p>
      <UsedUp rule={rule} status={status} />
      {told.length > 0 && (
        <ul className={classes.gates} data-testid="gates">
          {told.map((gate) => (
            <li key={gate.kind}>{sentence(gate.text)}</li>
          ))}
        </ul>
      )}
      <section className={page.section} aria-label="When">
        <h3>
          When{" "}
          <InWords
            plain={plainCondition(rule.event.condition, names)}
            expert={conditionText(rule.event.condition, names.constant)}
          />
        </h3>
        <LeafList leaves={leaves} of={rule.event.condition} />
      </section>
      {clear_leaves.length > 0 && (
        <section className={page.section} aria-label="Again after">
          <h3>Fires again after</h3>
          <LeafList leaves={clear_leaves} of={rule.event.clear} />
        </section>
      )}
      {status !== null && (
        <p className={page.muted}>
          Evaluated {status.evaluated.toLocaleString()}×, true {status.true.toLocaleString()}×,
          fired {status.fired}×, dropped {status.dropped}×, failed {status.failed}×
          {status.last_fired !== null && `; last fired ${whenText(status.last_fired, now)}`}.
        </p>
      )}
      <section className={page.section} aria-label="Near misses">
        <h3>Near misses</h3>
        {near_misses.length === 0 ? (
          <p className={page.muted}>It has not come close lately.</p>
        ) : (
          <ul className={classes.misses}>
            {near_misses.map((miss) => (
              <li key={miss.number}>
                <strong>{whenText(miss.time, now)}</strong> {sentence(miss.text)}
                <LeafList leaves={miss.leaves} of={rule.event.condition} then />
              </li>
            ))}
          </ul>
        )}
      </section>
      <Button
        variant="default"
        style={{ alignSelf: "flex-start" }}
        onClick={() => nav.go({ at: "firings", rule: found.rule_id })}
      >
        Its firings
      </Button>
    </>
  );
}

function Then({ found, gone }: { found: Explanation; gone: boolean }) {
  const nav = useNav();
  const names = useNames();
  const { event, actions } = found.rule;
  return (
    <section className={page.section} aria-label="The rule as it was">
      <h3>The rule as it was, in revision {found.revision}</h3>
      <p>
        When{" "}
        <InWords
          plain={plainCondition(event.condition, names)}
          expert={conditionText(event.condition, names.constant)}
        />
        , then{" "}
        <InWords
          plain={actions.map((each) => plainAction(each, names)).join(", then ")}
          expert={actions.map(actionText).join(", then ")}
        />
        .
      </p>
      {gone ? null : found.changed_since ? (
        <p className={page.note} data-testid="changed-since">
          It has been changed since.{" "}
          <button
            type="button"
            className={page.link}
            onClick={() => nav.go({ at: "history", revision: found.revision })}
          >
            Look at the history
          </button>
        </p>
      ) : (
        <p className={page.muted}>It is the same today.</p>
      )}
      {!gone && (
        <Button
          variant="default"
          style={{ alignSelf: "flex-start" }}
          onClick={() => nav.go({ at: "why", id: found.rule_id, firing: null })}
        >
          Why, or why not, now
        </Button>
      )}
    </section>
  );
}

const GATE_WORDS: Record<string, string> = {
  disabled: "it is switched off",
  rate_latched: "it fired too often",
  once: "it has fired once, and will not again until it is reset",
  unknown: "a value is missing or too old",
  false: "its condition is false",
  hold: "its condition is not true for long enough yet",
  not_armed: "it waits to re-arm",
  cooldown: "it cools down",
  busy: "its actions are still running",
};

/** What holds it back in a few words; the list below tells more. */
const gateText = ({ kind, text }: Explanation["gates"][number]): string => GATE_WORDS[kind] ?? text;
