import { Button } from "@mantine/core";
import type { ApplyReport } from "../../api/ruleTypes";
import page from "../../ui/page.module.css";
import { useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import { ruleName, secondsText } from "../model/words";
import { DiffList } from "../parts/DiffList";
import { EffectView } from "./EffectView";

/** What happened on the robot. */
export function Applied({ report }: { report: ApplyReport }) {
  const { view } = useRules();
  const nav = useNav();
  const names = new Map(view?.table.rules.map((rule) => [rule.id, ruleName(rule)]));
  return (
    <section className={page.section} aria-label="Result" data-testid="applied">
      <p className={page.note}>
        <strong>Revision {report.revision} is in force</strong> since a moment ago; the engine
        paused for {(report.pause * 1000).toFixed(2)} ms.{" "}
        {report.probation > 0
          ? `It goes back to what was confirmed after ${secondsText(report.probation)} unless you keep it.`
          : "It stays."}
      </p>
      <EffectView effect={report.effect} names={names} done />
      <DiffList changes={report.diff.changes} />
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
