import { useRobot } from "../state/RobotContext";
import { t } from "../texts/text";
import { Panel } from "../ui/Panel";
import { ComponentRow } from "./ComponentRow";
import classes from "./Health.module.css";
import { ProcessesRow } from "./ProcessesRow";

/** Every component of the stack: shape, word, age. */
export function HealthPanel() {
  const { state, elapsed, frozen } = useRobot();
  const components = state?.components ?? [];
  const silent =
    state === null
      ? t("Nothing heard yet.")
      : t("No component reports its status. Is the stack running on this ROS domain?");
  return (
    <Panel title={t("Health")} frozen={frozen} empty={components.length === 0 ? silent : null}>
      <ul className={classes.list}>
        {components.map((component) => (
          <ComponentRow key={component.name} component={component} elapsed={elapsed} />
        ))}
        {state !== null && <ProcessesRow processes={state.processes} />}
      </ul>
    </Panel>
  );
}
