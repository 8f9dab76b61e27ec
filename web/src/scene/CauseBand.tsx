import { useRobot } from "../state/RobotContext";
import { Band } from "../ui/Band";

/** One line: what is behind all that is wrong, and what follows from it; then what to do. */
export function CauseBand() {
  const { cause, frozen } = useRobot();
  if (cause === null || frozen || cause.minor) return null;
  const more = cause.others === 0 ? [] : [`${cause.others} more in Health`];
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
