import { useRobot } from "../state/RobotContext";
import { Band } from "../ui/Band";

/** What people do is not written down: said to all of them, and nobody is kept from anything. */
export function AuditBand() {
  const { state, frozen } = useRobot();
  if (frozen || !state?.audit_problem) return null;
  return (
    <Band tone="notice" testId="audit-band" title={state.audit_problem}>
      Look at the robot's disk. STOP and all else work as usual.
    </Band>
  );
}
