import { useRobot } from "../state/RobotContext";
import { t } from "../texts/text";
import { Band } from "../ui/Band";
import { silentDriveText } from "./driveText";

/** STOP goes through the drive manager: say so when there is none, before it is needed. */
export function DriveBand() {
  const { state, frozen, elapsed } = useRobot();
  if (state === null || frozen) return null;
  const text = silentDriveText(state.drive, elapsed);
  if (text === null) return null;
  return (
    <Band tone="notice" testId="drive-band" title={t("STOP cannot reach the robot from here.")}>
      {text}
    </Band>
  );
}
