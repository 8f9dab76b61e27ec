import { Button, TextInput } from "@mantine/core";
import { IconPlus, IconSearch } from "@tabler/icons-react";
import { useMemo, useState } from "react";
import type { Rule } from "../../api/ruleTypes";
import page from "../../ui/page.module.css";
import { newRule, putRule, ruleOf } from "../changes/draft";
import { useLive, useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import { ruleLines } from "../model/ruleLines";
import { useNames } from "../model/useNames";
import { ruleName } from "../model/words";
import { ExportMenu } from "./ExportMenu";
import { RuleRow } from "./RuleRow";
import classes from "./Table.module.css";

const FILTERS = ["all", "enabled", "trouble", "changed"] as const;
type Filter = (typeof FILTERS)[number];
const FILTER_WORDS: Record<Filter, string> = {
  all: "All",
  enabled: "On",
  trouble: "Trouble",
  changed: "Unsaved",
};
const TROUBLE = new Set(["broken", "latched", "unknown", "used up"]);

/** The rules in the order in which they are evaluated: what each waits for, does, and how it is. */
export function RuleTable() {
  const { view, draft, check, mayEdit } = useRules();
  const { rules: live } = useLive();
  const nav = useNav();
  const [search, setSearch] = useState("");
  const [filter, setFilter] = useState<Filter>("all");
  const table = draft.table;
  const names = useNames();
  const lines = useMemo(
    () => new Map(table?.rules.map((rule) => [rule.id, ruleLines(rule, names)])),
    [table, names],
  );
  if (view === null || table === null) {
    return <p className={page.empty}>Waiting for the rules of the robot…</p>;
  }
  const statuses = new Map(live?.statuses.map((status) => [status.rule_id, status]));
  const changed = new Map(draft.changes.map((change) => [change.rule_id, change]));
  const words = search.toLowerCase().split(/\s+/).filter(Boolean);
  const fits = (rule: Rule): boolean => {
    const status = statuses.get(rule.id);
    if (filter === "enabled" && !rule.enabled) return false;
    if (filter === "changed" && !changed.has(rule.id)) return false;
    if (
      filter === "trouble" &&
      !(status && (TROUBLE.has(status.state) || status.last_ok === false))
    )
      return false;
    const line = lines.get(rule.id);
    const text =
      `${ruleName(rule)} ${rule.id} ${line?.when} ${line?.does} ${line?.plain.when} ${line?.plain.does} ${rule.note}`.toLowerCase();
    return words.every((word) => text.includes(word));
  };
  const shown = table.rules.filter(fits);
  const removed = draft.changes.filter((change) => change.kind === "removed");

  const add = () => {
    const rule = newRule(table);
    draft.edit((from) => putRule(from, rule));
    nav.go({ at: "edit", id: rule.id });
  };
  return (
    <div className={classes.table} data-testid="rule-table">
      <div className={classes.tools}>
        <TextInput
          type="search"
          size="sm"
          className={classes.search}
          aria-label="Search rules"
          placeholder="Search rules"
          leftSection={<IconSearch size={16} aria-hidden />}
          value={search}
          data-testid="rule-search"
          onChange={(event) => setSearch(event.currentTarget.value)}
        />
        {mayEdit && (
          <Button
            leftSection={<IconPlus size={16} aria-hidden />}
            onClick={add}
            id="rule-add"
            data-testid="rule-add"
          >
            Add rule
          </Button>
        )}
        <fieldset className={classes.filters} aria-label="Which rules">
          {FILTERS.map((each) => (
            <button
              key={each}
              type="button"
              className={classes.filter}
              aria-pressed={filter === each}
              data-testid={`rule-filter-${each}`}
              onClick={() => setFilter(each)}
            >
              {FILTER_WORDS[each]}
            </button>
          ))}
        </fieldset>
        <ExportMenu />
      </div>
      <ul className={classes.list} aria-label="Rules">
        {shown.map((rule) => (
          <RuleRow
            key={rule.id}
            rule={rule}
            lines={lines.get(rule.id)}
            status={statuses.get(rule.id) ?? null}
            change={changed.get(rule.id) ?? null}
            findings={check.findings.filter((finding) => finding.rule_id === rule.id)}
            fromRecipe={view.from_recipe.includes(rule.id)}
          />
        ))}
        {filter !== "enabled" &&
          filter !== "trouble" &&
          removed.map((change) => {
            const was = draft.draft === null ? null : ruleOf(draft.draft.baseTable, change.rule_id);
            return was === null ? null : (
              <RemovedRuleRow
                key={change.rule_id}
                rule={was}
                onUndo={() => draft.discard(change.rule_id)}
              />
            );
          })}
      </ul>
      {shown.length === 0 && removed.length === 0 && (
        <p className={page.empty}>
          {table.rules.length === 0
            ? "There are no rules yet. A rule says what is done when something happens; Add rule begins with what people often want."
            : "No rule is like that. Clear the search, or look at all."}
        </p>
      )}
    </div>
  );
}

/** A rule that will be gone once the changes are applied. */
function RemovedRuleRow({ rule, onUndo }: { rule: Rule; onUndo: () => void }) {
  return (
    <li className={classes.rule} data-removed data-testid={`rule-${rule.id}`}>
      <div className={classes.first}>
        <s className={classes.name}>{ruleName(rule)}</s>
        <span className={classes.change}>will be deleted</span>
        <Button variant="default" size="compact-md" onClick={onUndo}>
          Keep it
        </Button>
      </div>
    </li>
  );
}
