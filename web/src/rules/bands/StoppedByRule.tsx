import { Button } from "@mantine/core";
import { useStop } from "../../stop/StopContext";
import { t } from "../../texts/text";
import { useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import { useFirings } from "../firings/useFirings";
import { ruleName } from "../model/words";

/** From the band of a robot that a rule has stopped to why that rule did. */
export function StoppedByRule() {
  const { drive } = useStop();
  const by = drive?.stopped ? drive.stopped_by : "";
  return by.startsWith("rule ") ? <Why by={by} /> : null;
}

/** Among so many of the newest firings the one that stopped the robot is looked for. */
const LOOKED_AT = 50;

function Why({ by }: { by: string }) {
  const { view } = useRules();
  const { firings } = useFirings(LOOKED_AT, null);
  const nav = useNav();
  // As the monitor signs the STOP of a rule. The rule may be gone from the table by now: taken back.
  const firing = firings?.find(
    ({ kind, name, rule_id }) => kind === "firing" && by === `rule ${name || rule_id}`,
  );
  const rule = view?.table.rules.find((each) => by === `rule ${ruleName(each)}`);
  const id = firing?.rule_id ?? rule?.id;
  if (id === undefined) return null;
  return (
    <Button
      variant="default"
      onClick={() => nav.go({ at: "why", id, firing: firing ?? null })}
      data-testid="stop-why"
    >
      {t("Why?")}
    </Button>
  );
}
