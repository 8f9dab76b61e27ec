import { useRobot } from "../state/RobotContext";
import { t } from "../texts/text";
import { langOf, told } from "../texts/told";
import { Panel } from "../ui/Panel";
import { FitRow } from "./FitRow";
import classes from "./Health.module.css";
import { StreamRow } from "./StreamRow";

/** What reaches the console from the robot, and how old it is. */
export function DataPanel() {
  const { state, elapsed, frozen } = useRobot();
  const streams = state?.streams ?? [];
  return (
    <Panel
      title={t("Data")}
      frozen={frozen}
      empty={streams.length === 0 ? t("Nothing heard yet.") : null}
    >
      <ul className={classes.list}>
        {streams.map((stream) => (
          <StreamRow key={stream.key} stream={stream} elapsed={elapsed} />
        ))}
        {state !== null && <FitRow localisation={state.localisation} elapsed={elapsed} />}
      </ul>
      {state?.robot.problem && (
        <p className={classes.note} lang={langOf(state.robot.problem)}>
          {told(state.robot.problem)}
        </p>
      )}
    </Panel>
  );
}
