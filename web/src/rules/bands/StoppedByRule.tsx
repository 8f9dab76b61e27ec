import { Button } from "@mantine/core";
import { useStop } from "../../stop/StopContext";
import { useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import { ruleName } from "../model/words";

/** From the band of a robot that a rule has stopped to why that rule did. */
export function StoppedByRule() {
  const { drive } = useStop();
  const { view } = useRules();
  const nav = useNav();
  const by = drive?.stopped ? drive.stopped_by : "";
  // As the monitor signs the STOP of a rule.
  const rule = view?.table.rules.find((each) => by === `rule ${ruleName(each)}`);
  if (rule === undefined) return null;
  return (
    <Button
      variant="default"
      onClick={() => nav.go({ at: "why", id: rule.id, firing: null })}
      data-testid="stop-why"
    >
      Why?
    </Button>
  );
}
