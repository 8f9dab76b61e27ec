import { Button, Select } from "@mantine/core";
import { useState } from "react";
import type { Firing } from "../../api/ruleTypes";
import { type Phrase, t } from "../../texts/text";
import { Choice } from "../../ui/controls/Choice";
import { Problem } from "../../ui/Problem";
import page from "../../ui/page.module.css";
import { useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import { ruleName } from "../model/words";
import { FiringList } from "./FiringList";
import { useFirings } from "./useFirings";

const OUTCOMES: { value: string; label: Phrase }[] = [
  { value: "all", label: "everything" },
  { value: "fired", label: "firings" },
  { value: "failed", label: "failed" },
  { value: "running", label: "still running" },
  { value: "shadow", label: "shadow" },
  { value: "near miss", label: "near misses" },
  { value: "outranked", label: "outranked" },
  { value: "note", label: "notes" },
];

function fits(firing: Firing, outcome: string): boolean {
  switch (outcome) {
    case "all":
      return true;
    case "fired":
      return firing.kind === "firing";
    case "failed":
      return firing.ok === false;
    case "running":
      return firing.kind === "firing" && firing.ended === null;
    default:
      return firing.kind === outcome;
  }
}

/** The journal: what fired and what came of it, newest first. */
export function FiringsPage({ rule }: { rule: string | null }) {
  const { view } = useRules();
  const nav = useNav();
  const [outcome, setOutcome] = useState("all");
  const { firings, more, error, older } = useFirings(50, rule);
  const shown = firings?.filter((firing) => fits(firing, outcome)) ?? [];
  const rules = (view?.table.rules ?? []).map((each) => ({
    value: each.id,
    label: ruleName(each),
  }));
  const known = rule === null || rules.some(({ value }) => value === rule);
  return (
    <div className={page.page} data-testid="firings">
      <div className={page.pair}>
        <Select
          size="sm"
          aria-label={t("Of which rule")}
          placeholder={t("of any rule")}
          clearable
          searchable
          data={known ? rules : [...rules, { value: rule, label: rule }]}
          value={rule}
          onChange={(id) => nav.go({ at: "firings", rule: id })}
        />
        <Choice
          aria-label={t("Which outcome")}
          data={OUTCOMES.map(({ value, label }) => ({ value, label: t(label) }))}
          value={outcome}
          onChange={setOutcome}
        />
      </div>
      <Problem error={error} />
      {firings === null && error === null && (
        <p className={page.muted}>{t("Reading the journal…")}</p>
      )}
      {firings !== null && shown.length === 0 && (
        <p className={page.empty}>
          {firings.length === 0 ? t("Nothing has fired yet.") : t("Nothing like that lately.")}
        </p>
      )}
      <FiringList firings={shown} />
      {more && (
        <Button variant="default" onClick={older}>
          {t("Older")}
        </Button>
      )}
    </div>
  );
}
