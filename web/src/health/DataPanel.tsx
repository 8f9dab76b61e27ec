import { useRobot } from "../state/RobotContext";
import classes from "./Health.module.css";
import { StreamRow } from "./StreamRow";

/** What reaches the console from the robot, and how old it is. */
export function DataPanel() {
  const { state, elapsed, frozen } = useRobot();
  const streams = state?.streams ?? [];
  return (
    <section className={classes.panel} data-frozen={frozen || undefined} aria-label="Data">
      <h2 className={classes.title}>Data</h2>
      {streams.length === 0 ? (
        <p className={classes.empty}>Nothing heard yet.</p>
      ) : (
        <ul className={classes.list}>
          {streams.map((stream) => (
            <StreamRow key={stream.key} stream={stream} elapsed={elapsed} />
          ))}
        </ul>
      )}
    </section>
  );
}
