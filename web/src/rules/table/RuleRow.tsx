import { Button } from "@mantine/core";
import { IconPencil, IconZoomQuestion } from "@tabler/icons-react";
import type { Finding, Rule, RuleChange, RuleStatus } from "../../api/ruleTypes";
import { useNow } from "../../state/RobotContext";
import { Toggle } from "../../ui/controls/Toggle";
import { StatusMark } from "../../ui/StatusMark";
import { putRule } from "../changes/draft";
import { useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import type { RuleLines } from "../model/ruleLines";
import { ruleName, statusLevel, statusText, whenText } from "../model/words";
import { FindingList } from "../parts/FindingList";
import { InWords } from "../parts/InWords";
import { UsedUp } from "../parts/UsedUp";
import { RuleMenu } from "./RuleMenu";
import classes from "./Table.module.css";

interface Props {
  rule: Rule;
  lines: RuleLines | undefined;
  status: RuleStatus | null;
  /** What will be different once it is applied. */
  change: RuleChange | null;
  findings: Finding[];
  fromRecipe: boolean;
}

/** One rule: what it waits for, what it does, how it is, and what one can do with it. */
export function RuleRow({ rule, lines, status, change, findings, fromRecipe }: Props) {
  const { draft, mayEdit } = useRules();
  const nav = useNav();
  const name = ruleName(rule);
  const level = statusLevel(status, rule);
  const state = statusText(status, rule);
  return (
    <li
      className={classes.rule}
      data-testid={`rule-${rule.id}`}
      data-state={status?.state}
      data-off={!rule.enabled || undefined}
    >
      <div className={classes.first}>
        <StatusMark level={level} />
        <h3 className={classes.name}>{name}</h3>
        <span className={classes.state} data-level={level} data-testid="rule-state">
          {state}
        </span>
      </div>
      <dl className={classes.what}>
        <dt>when</dt>
        <dd>
          <span className={classes.code}>
            {lines && <InWords plain={lines.plain.when} expert={lines.when} />}
          </span>
          {lines?.timing.map((part) => (
            <span key={part} className={classes.timing}>
              {part}
            </span>
          ))}
        </dd>
        <dt>then</dt>
        <dd>{lines && <InWords plain={lines.plain.does} expert={lines.does} />}</dd>
      </dl>
      <div className={classes.indented}>
        <UsedUp rule={rule} status={status} />
      </div>
      {change !== null && (
        <div className={classes.changed}>
          <span className={classes.change} data-testid="rule-change">
            Not applied yet: {change.kind === "added" ? "it is new" : change.summary}
          </span>
          <Button
            variant="subtle"
            size="compact-sm"
            onClick={() => draft.discard(rule.id)}
            data-testid="rule-discard"
          >
            Undo
          </Button>
        </div>
      )}
      <FindingList findings={findings} />
      <div className={classes.last}>
        <Facts rule={rule} status={status} fromRecipe={fromRecipe} />
        <span className={classes.buttons}>
          <Button
            variant="default"
            size="compact-md"
            leftSection={<IconZoomQuestion size={16} aria-hidden />}
            aria-label={`Why, or why not: ${name}`}
            id={`why-${rule.id}`}
            data-testid="rule-why"
            onClick={() => nav.go({ at: "why", id: rule.id, firing: null })}
          >
            Why
          </Button>
          {mayEdit && (
            <>
              <Button
                variant="default"
                size="compact-md"
                leftSection={<IconPencil size={16} aria-hidden />}
                aria-label={`Edit ${name}`}
                id={`edit-${rule.id}`}
                data-testid="rule-edit"
                onClick={() => nav.go({ at: "edit", id: rule.id })}
              >
                Edit
              </Button>
              <Toggle
                on={rule.enabled}
                label={`${name} enabled`}
                disabled={rule.protected}
                title={
                  rule.protected
                    ? "Protected: it cannot be switched off"
                    : rule.enabled
                      ? "Switch off"
                      : "Switch on"
                }
                testId="rule-toggle"
                onChange={(enabled) => draft.edit((table) => putRule(table, { ...rule, enabled }))}
              />
              <RuleMenu rule={rule} status={status} />
            </>
          )}
        </span>
      </div>
    </li>
  );
}

function Facts({ rule, status, fromRecipe }: Pick<Props, "rule" | "status" | "fromRecipe">) {
  const now = useNow();
  const facts: string[] = [];
  if (!rule.enabled && status !== null && status.state !== "disabled")
    facts.push("off once applied");
  if (rule.lane === "safety") facts.push("safety lane");
  if (rule.protected) facts.push("protected");
  if (rule.shadow) facts.push("shadow: does not act");
  if (fromRecipe) facts.push("code of the recipe");
  if (status !== null) {
    facts.push(status.fired === 0 ? "never fired" : `fired ${status.fired}×`);
    if (status.dropped > 0) facts.push(`dropped ${status.dropped}×`);
    if (status.failed > 0) facts.push(`failed ${status.failed}×`);
    if (status.outranked > 0) facts.push(`outranked ${status.outranked}×`);
    if (status.last_fired !== null) {
      // While it runs, the outcome is still that of the time before.
      const known = status.state !== "running" && status.last_ok !== null;
      const how = known ? (status.last_ok ? " ok" : " failed") : "";
      facts.push(`last ${whenText(status.last_fired, now)}${how}`);
    }
  }
  return (
    <span className={classes.facts} data-testid="rule-facts">
      {facts.join(" · ")}
    </span>
  );
}
