import { GoalStatus } from "../goal/GoalStatus";
import { DataPanel } from "../health/DataPanel";
import { HealthPanel } from "../health/HealthPanel";
import { StopButton } from "../stop/StopButton";
import classes from "./SidePanel.module.css";

/** The right column of a wide page. STOP has its own corner, which nothing scrolls under. */
export function SidePanel() {
  return (
    <aside className={classes.side} aria-label="Robot">
      <div className={classes.scroll}>
        <div className={classes.goal}>
          <GoalStatus />
        </div>
        <HealthPanel />
        <DataPanel />
      </div>
      <div className={classes.stop}>
        <StopButton />
      </div>
    </aside>
  );
}
