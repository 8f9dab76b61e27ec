import { useRobot } from "../state/RobotContext";
import { ComponentRow } from "./ComponentRow";
import classes from "./Health.module.css";

/** Every component of the stack: shape, word, age. */
export function HealthPanel() {
  const { state, elapsed, frozen } = useRobot();
  const components = state?.components ?? [];
  return (
    <section className={classes.panel} data-frozen={frozen || undefined} aria-label="Health">
      <h2 className={classes.title}>Health</h2>
      {components.length === 0 ? (
        <p className={classes.empty}>
          {state === null
            ? "Nothing heard yet."
            : "No component reports its status. Is the stack running on this ROS domain?"}
        </p>
      ) : (
        <ul className={classes.list}>
          {components.map((component) => (
            <ComponentRow key={component.name} component={component} elapsed={elapsed} />
          ))}
        </ul>
      )}
    </section>
  );
}
