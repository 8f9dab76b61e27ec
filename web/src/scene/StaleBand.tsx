import { wholeAgeText } from "../format";
import { POSE_DEADLINE_S } from "../state/overall";
import { useRobot } from "../state/RobotContext";
import { t } from "../texts/text";
import { Band } from "../ui/Band";

/** A position as old as this is told across the scene; younger ones only grey out. */
const TELL_AFTER_S = Math.max(1, POSE_DEADLINE_S);

/** Says that the scene shows the past. */
export function StaleBand() {
  const { state, elapsed, frozen, connected, cause } = useRobot();
  if (frozen) {
    const since = wholeAgeText(elapsed);
    return (
      <Band
        tone="stale"
        testId="stale-band"
        title={
          state === null
            ? connected
              ? t("Waiting for the robot: no data for {since}.", { since })
              : t("Waiting for the robot: no data for {since}, connecting…", { since })
            : connected
              ? t("View is frozen: no data from the robot for {since}.", { since })
              : t("View is frozen: no data from the robot for {since}, reconnecting…", { since })
        }
      >
        {state !== null && t("The robot may have moved. STOP still tries to reach it.")}
      </Band>
    );
  }
  if (state === null) return null;
  if (state.pose === null) {
    return (
      <Band
        tone="stale"
        testId="stale-band"
        title={t("Position unknown: no odometry received yet.")}
      />
    );
  }
  const age = state.pose.age + elapsed;
  // What is behind it is told above, with the same age.
  if (age < TELL_AFTER_S || (cause !== null && !cause.minor)) return null;
  return (
    <Band
      tone="stale"
      testId="stale-band"
      title={t("Position is {age} old.", { age: wholeAgeText(age) })}
    >
      {t("The robot may be elsewhere; check its odometry.")}
    </Band>
  );
}
