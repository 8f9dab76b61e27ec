import { useRobot } from "../state/RobotContext";
import { t } from "../texts/text";
import { told } from "../texts/told";
import { Band } from "../ui/Band";

/** What people do is not written down: said to all of them, and nobody is kept from anything. */
export function AuditBand() {
  const { state, frozen } = useRobot();
  if (frozen || !state?.audit_problem) return null;
  return (
    <Band tone="notice" testId="audit-band" title={told(state.audit_problem)}>
      {t("Look at the robot's disk. STOP and all else work as usual.")}
    </Band>
  );
}
