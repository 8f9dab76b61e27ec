import { useRobot } from "../state/RobotContext";
import { t } from "../texts/text";
import { told } from "../texts/told";
import { Band } from "../ui/Band";

/** Somebody who relies on being told is not: said to all, for one of them may know whom to call. */
export function WebhookBand() {
  const { state, frozen } = useRobot();
  if (frozen || !state?.webhook_problem) return null;
  return (
    <Band tone="notice" testId="webhook-band" title={told(state.webhook_problem)}>
      {t("Whoever is told by it hears nothing of this robot. STOP and all else work as usual.")}
    </Band>
  );
}
