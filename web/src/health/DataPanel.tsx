import { useRobot } from "../state/RobotContext";
import { Panel } from "../ui/Panel";
import { FitRow } from "./FitRow";
import classes from "./Health.module.css";
import { StreamRow } from "./StreamRow";

/** What reaches the console from the robot, and how old it is. */
export function DataPanel() {
  const { state, elapsed, frozen } = useRobot();
  const streams = state?.streams ?? [];
  return (
    <Panel title="Data" frozen={frozen} empty={streams.length === 0 ? "Nothing heard yet." : null}>
      <ul className={classes.list}>
        {streams.map((stream) => (
          <StreamRow key={stream.key} stream={stream} elapsed={elapsed} />
        ))}
        {state !== null && <FitRow localisation={state.localisation} elapsed={elapsed} />}
      </ul>
      {state?.robot.problem && <p className={classes.note}>{state.robot.problem}</p>}
    </Panel>
  );
}
