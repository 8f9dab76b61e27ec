import { Textarea } from "@mantine/core";
import type { Rule } from "../../api/ruleTypes";
import { Choice } from "../../ui/controls/Choice";
import { Toggle } from "../../ui/controls/Toggle";
import page from "../../ui/page.module.css";
import { useRules } from "../context/RulesContext";
import { SEVERITIES } from "../model/words";
import classes from "./form/Editor.module.css";

/** How a rule stands among the others, and a note for who reads it next. */
export function RuleSettings({ rule, onChange }: { rule: Rule; onChange: (rule: Rule) => void }) {
  const { mayProtect } = useRules();
  return (
    <section className={page.section} aria-label="Settings">
      <div className={page.title}>
        <h2>Settings</h2>
      </div>
      <div className={classes.grid}>
        <Choice
          label="Severity"
          data-testid="severity"
          description="Which rule wins over a component"
          data={[...SEVERITIES]}
          value={rule.severity}
          onChange={(severity) => onChange({ ...rule, severity: severity as Rule["severity"] })}
        />
        <Choice
          label="Lane"
          description="Safety never waits for others"
          data={["normal", "safety"]}
          value={rule.lane}
          onChange={(lane) => onChange({ ...rule, lane: lane as Rule["lane"] })}
        />
      </div>
      <div className={page.line}>
        <Toggle
          on={rule.enabled}
          label="Enabled"
          disabled={rule.protected}
          onChange={(enabled) => onChange({ ...rule, enabled })}
        >
          enabled
        </Toggle>
        <Toggle
          on={rule.shadow}
          label="Shadow"
          disabled={rule.protected}
          title="Evaluated and recorded, without acting"
          onChange={(shadow) => onChange({ ...rule, shadow })}
        >
          shadow: watch only, do not act
        </Toggle>
        <Toggle
          on={rule.protected}
          label="Protected"
          disabled={!mayProtect}
          title={mayProtect ? "Cannot be edited away" : "Only an engineer may protect a rule"}
          onChange={(on) => onChange({ ...rule, protected: on })}
        >
          protected
        </Toggle>
      </div>
      <Textarea
        label="Note"
        size="sm"
        autosize
        minRows={1}
        maxRows={6}
        value={rule.note}
        onChange={(event) => onChange({ ...rule, note: event.currentTarget.value })}
      />
    </section>
  );
}
