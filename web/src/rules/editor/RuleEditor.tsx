import { Button, TextInput } from "@mantine/core";
import { useEffect, useMemo } from "react";
import type { Rule } from "../../api/ruleTypes";
import page from "../../ui/page.module.css";
import { freeId, putRule, removeRule, ruleOf } from "../changes/draft";
import { findingsElsewhere } from "../changes/findings";
import { useLive, useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import { ruleName } from "../model/words";
import { FindingList } from "../parts/FindingList";
import { PageTitle } from "../parts/PageTitle";
import { UsedUp } from "../parts/UsedUp";
import { ActionList } from "./action/ActionList";
import { ConditionEditor } from "./condition/ConditionEditor";
import { type Editor, EditorProvider } from "./form/EditorContext";
import { ProbeProvider, VerdictLine } from "./form/Probe";
import { RuleSettings } from "./RuleSettings";
import { TimingFields } from "./TimingFields";

/** The form of one rule. Every keystroke goes into the draft: there is nothing to save here. */
export function RuleEditor({ id }: { id: string }) {
  const { draft, view, mayEdit } = useRules();
  const nav = useNav();
  const rule = draft.table === null ? null : ruleOf(draft.table, id);
  if (rule === null || view === null) {
    return (
      <div className={page.page}>
        <p className={page.muted}>This rule is no longer there.</p>
        <Button variant="default" onClick={() => nav.go({ at: "table" })}>
          To the rules
        </Button>
      </div>
    );
  }
  // While another rule of the same form is open nothing of this one may be kept: hence the key.
  return <Form key={view.robot} rule={rule} readOnly={!mayEdit} />;
}

function Form({ rule, readOnly }: { rule: Rule; readOnly: boolean }) {
  const { draft, view, graph, check, reloadGraph } = useRules();
  const { rules: live } = useLive();
  const nav = useNav();
  useEffect(reloadGraph, [reloadGraph]);

  const findings = useMemo(
    () => check.findings.filter((finding) => finding.rule_id === rule.id),
    [check.findings, rule.id],
  );
  const editor = useMemo<Editor>(() => ({ graph, findings }), [graph, findings]);

  const put = (next: Rule) => draft.edit((table) => putRule(table, next));
  const isNew = view !== null && ruleOf(view.table, rule.id) === null;
  // A new rule is known by its name; one that the robot knows keeps what it is known by.
  const named = () => {
    if (!isNew || rule.name.trim() === "") return;
    const table = draft.table;
    if (table === null) return;
    const id = freeId(removeRule(table, rule.id), rule.name);
    if (id === rule.id) return;
    draft.edit((from) => ({
      rules: from.rules.map((other) => (other.id === rule.id ? { ...other, id } : other)),
    }));
    nav.go({ at: "edit", id });
  };
  const shown = [
    "event.condition",
    "event.clear",
    "actions",
    "name",
    "event.hold",
    "event.cooldown",
  ];
  return (
    <EditorProvider value={editor}>
      <ProbeProvider condition={rule.event.condition} clear={rule.event.clear}>
        <fieldset className={page.section} disabled={readOnly}>
          <div className={page.page} data-testid="rule-editor">
            <PageTitle
              title={isNew ? "New rule" : ruleName(rule)}
              back="Rules"
              testId="editor-back"
              onBack={() => nav.go({ at: "table" })}
            >
              <span className={page.muted} data-testid="editor-kept">
                {draft.changes.some((change) => change.rule_id === rule.id)
                  ? "kept as unsaved change"
                  : "as in force"}
              </span>
            </PageTitle>
            <UsedUp
              rule={rule}
              status={live?.statuses.find((status) => status.rule_id === rule.id) ?? null}
            />
            <FindingList findings={findingsElsewhere(findings, shown)} />
            <TextInput
              label="Name"
              placeholder="What it is for, in a few words"
              size="sm"
              value={rule.name}
              // What is typed next is its name, and no shortcuts of the page.
              autoFocus={isNew && rule.name === ""}
              data-testid="rule-name"
              onChange={(event) => put({ ...rule, name: event.currentTarget.value })}
              onBlur={named}
            />
            <section className={page.section} aria-label="When">
              <div className={page.title}>
                <h2>When</h2>
                <VerdictLine of="condition" />
              </div>
              <ConditionEditor
                root="event.condition"
                condition={rule.event.condition}
                onChange={(condition) => put({ ...rule, event: { ...rule.event, condition } })}
              />
            </section>
            <TimingFields event={rule.event} onChange={(event) => put({ ...rule, event })} />
            <section className={page.section} aria-label="Then">
              <div className={page.title}>
                <h2>Then</h2>
              </div>
              <ActionList
                actions={rule.actions}
                condition={rule.event.condition}
                onChange={(actions) => put({ ...rule, actions })}
              />
            </section>
            <RuleSettings rule={rule} onChange={put} />
            <div className={page.line}>
              <Button
                variant="default"
                onClick={() => nav.go({ at: "table" })}
                data-testid="editor-done"
              >
                Done
              </Button>
              {draft.changes.some((change) => change.rule_id === rule.id) && (
                <Button
                  variant="subtle"
                  onClick={() => {
                    draft.discard(rule.id);
                    if (isNew) nav.go({ at: "table" });
                  }}
                >
                  {isNew ? "Drop this rule" : "Undo the changes of this rule"}
                </Button>
              )}
            </div>
          </div>
        </fieldset>
      </ProbeProvider>
    </EditorProvider>
  );
}
