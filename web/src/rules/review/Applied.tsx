import { Button } from "@mantine/core";
import type { ApplyReport, Table } from "../../api/ruleTypes";
import page from "../../ui/page.module.css";
import { useProbation } from "../bands/useProbation";
import { useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import { type Standing, standing } from "../model/standing";
import { ruleName, secondsText } from "../model/words";
import { DiffList } from "../parts/DiffList";
import { EffectView } from "./EffectView";

function headline(revision: number, now: Standing): string {
  return now.is === "replaced"
    ? `Revision ${revision} was applied, and is no longer in force: revision ${now.by} is.`
    : `Revision ${revision} is in force.`;
}

function prospect(now: Standing): string {
  switch (now.is) {
    case "probation":
      return `It goes back to what was confirmed in ${secondsText(now.left)} unless you keep it.`;
    case "kept":
      return "It stays.";
    case "replaced":
      return "";
  }
}

/** What happened on the robot, and where it stands since. */
export function Applied({ report, rules }: { report: ApplyReport; rules: Table["rules"] }) {
  const { view } = useRules();
  const nav = useNav();
  const now = standing(report, useProbation());
  const names = new Map(
    [...rules, ...(view?.table.rules ?? [])].map((rule) => [rule.id, ruleName(rule)]),
  );
  return (
    <section className={page.section} aria-label="Result" data-testid="applied">
      <p className={page.note}>
        <strong>{headline(report.revision, now)}</strong> The engine paused for{" "}
        {(report.pause * 1000).toFixed(2)} ms. {prospect(now)}
      </p>
      <EffectView effect={report.effect} names={names} done />
      <DiffList changes={report.diff.changes} rules={[...(view?.table.rules ?? []), ...rules]} />
      <div className={page.line}>
        <Button
          variant="default"
          onClick={() => nav.go({ at: "table" })}
          data-testid="applied-done"
        >
          To the rules
        </Button>
      </div>
    </section>
  );
}
