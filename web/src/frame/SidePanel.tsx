import type { Place, Zone } from "../api/types";
import { GoalStatus } from "../goal/GoalStatus";
import { DataPanel } from "../health/DataPanel";
import { HealthPanel } from "../health/HealthPanel";
import { LogPanel } from "../log/LogPanel";
import { MissionStatus } from "../missions/MissionStatus";
import { MissionsPanel } from "../missions/MissionsPanel";
import { MissionsTo } from "../missions/MissionsTo";
import { PlacesPanel } from "../places/PlacesPanel";
import { useNav } from "../rules/context/RulesNav";
import { DraftBar } from "../rules/DraftBar";
import { FiringsPanel } from "../rules/firings/FiringsPanel";
import { RulesSheet } from "../rules/RulesSheet";
import { StopPlace } from "../stop/StopButton";
import { memoInLanguage } from "../texts/memoInLanguage";
import { t } from "../texts/text";
import { Parts } from "../ui/Parts";
import { ZonesPanel } from "../zones/ZonesPanel";
import classes from "./SidePanel.module.css";

export interface Props {
  /** Looks at the way to a place; null while the robot cannot be sent from here. */
  onGo: ((place: Place) => void) | null;
  /** Counts how often somebody asked for the places. */
  asked: number;
  /** Begins to draw a zone, or to change one; null while that cannot be. */
  onDraw: ((zone: Zone | null) => void) | null;
}

/**
 * The right column of a wide page, or the rules in its place. STOP has its own corner, which nothing
 * scrolls under.
 */
export const SidePanel = memoInLanguage(function SidePanel({ onGo, asked, onDraw }: Props) {
  const { open } = useNav();
  if (open) {
    return (
      <aside className={classes.side} aria-label={t("Rules and goal")}>
        <Parts>
          <RulesSheet />
        </Parts>
        <div className={classes.foot}>
          <div className={classes.footText}>
            <Parts>
              <MissionStatus brief />
              <GoalStatus />
              <DraftBar />
            </Parts>
          </div>
          <StopPlace />
        </div>
      </aside>
    );
  }
  return (
    <aside className={classes.side} aria-label={t("Robot")}>
      <div className={classes.scroll}>
        <div className={classes.goal}>
          <Parts>
            <MissionStatus />
            <GoalStatus />
          </Parts>
        </div>
        <Parts>
          <HealthPanel />
          <PlacesPanel onGo={onGo} asked={asked} deleted={MissionsTo} />
          <MissionsPanel />
          <ZonesPanel onDraw={onDraw} />
          <LogPanel />
          <FiringsPanel />
          <DataPanel />
        </Parts>
      </div>
      <div className={classes.stop}>
        <StopPlace />
      </div>
    </aside>
  );
});
