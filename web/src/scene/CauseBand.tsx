import { useRobot } from "../state/RobotContext";
import { t } from "../texts/text";
import { Band } from "../ui/Band";

/** One line: what is behind all that is wrong, and what follows from it; then what to do. */
export function CauseBand() {
  const { cause, frozen } = useRobot();
  if (cause === null || frozen || cause.minor) return null;
  const more = cause.others === 0 ? [] : [t("{others} more in Health", { others: cause.others })];
  return (
    <Band
      tone="notice"
      testId="cause-band"
      title={[cause.text, ...cause.effects, ...more].join(" · ")}
    >
      {cause.advice}
    </Band>
  );
}
