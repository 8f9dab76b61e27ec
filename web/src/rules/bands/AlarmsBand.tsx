import { useNow } from "../../state/RobotContext";
import { Band } from "../../ui/Band";
import { useLive, useRules } from "../context/RulesContext";
import { ruleName, whenText } from "../model/words";

const LOUD = new Set(["error", "critical"]);

/** Alarms that rules have raised, until a rule clears them. */
export function AlarmsBand() {
  const { rules } = useLive();
  const { view } = useRules();
  const now = useNow();
  const alarms = rules?.alarms ?? [];
  return alarms.map((alarm) => {
    const rule = view?.table.rules.find(({ id }) => id === alarm.rule_id);
    return (
      <Band
        key={alarm.name}
        tone={LOUD.has(alarm.severity) ? "failed" : "notice"}
        title={`Alarm: ${alarm.name}`}
        testId="alarm-band"
      >
        {alarm.text !== "" && `${alarm.text} `}
        {rule !== undefined && `Raised by "${ruleName(rule)}" `}
        {whenText(alarm.since, now)}
        {alarm.count > 1 && `, ${alarm.count} times`}
      </Band>
    );
  });
}
