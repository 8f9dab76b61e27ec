import { useRobot } from "../state/RobotContext";
import { Band } from "../ui/Band";

/** STOP goes through the drive manager: say so when there is none, before it is needed. */
export function DriveBand() {
  const { state, frozen } = useRobot();
  if (state === null || frozen || state.drive?.available) return null;
  return (
    <Band tone="notice" testId="drive-band" title="STOP cannot reach the robot from here.">
      No drive manager was found on the network. Start the stack, or use the robot's own button.
    </Band>
  );
}
