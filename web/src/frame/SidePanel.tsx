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
import { Part } from "../ui/Part";
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
  const { open, place } = useNav();
  if (open) {
    return (
      <aside className={classes.side} aria-label={t("Rules and goal")}>
        <Part>
          <RulesSheet />
        </Part>
        <div className={classes.foot}>
          <div className={classes.footText}>
            <Part>
              <MissionStatus brief />
              <GoalStatus />
            </Part>
            {place.at !== "timeline" && <DraftBar />}
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
          <Part>
            <MissionStatus />
            <GoalStatus />
          </Part>
        </div>
        <Part>
          <HealthPanel />
        </Part>
        <Part>
          <PlacesPanel onGo={onGo} asked={asked} deleted={MissionsTo} />
        </Part>
        <Part>
          <MissionsPanel />
        </Part>
        <Part>
          <ZonesPanel onDraw={onDraw} />
        </Part>
        <Part>
          <LogPanel />
        </Part>
        <Part>
          <FiringsPanel />
        </Part>
        <Part>
          <DataPanel />
        </Part>
      </div>
      <div className={classes.stop}>
        <StopPlace />
      </div>
    </aside>
  );
});
