import { SegmentedControl, UnstyledButton } from "@mantine/core";
import { IconBolt, IconDatabase, IconHeartbeat, IconMapPins } from "@tabler/icons-react";
import { useState } from "react";
import type { Place, Zone } from "../api/types";
import { GoalStatus } from "../goal/GoalStatus";
import { DataPanel } from "../health/DataPanel";
import { HealthPanel } from "../health/HealthPanel";
import { LogPanel } from "../log/LogPanel";
import { MissionStatus } from "../missions/MissionStatus";
import { MissionsPanel } from "../missions/MissionsPanel";
import { MissionsTo } from "../missions/MissionsTo";
import { PlacesPanel } from "../places/PlacesPanel";
import { StoppedByRule } from "../rules/bands/StoppedByRule";
import { OPENERS, useNav } from "../rules/context/RulesNav";
import { DraftBar } from "../rules/DraftBar";
import { FiringsPanel } from "../rules/firings/FiringsPanel";
import { RulesSheet } from "../rules/RulesSheet";
import { DriveBand } from "../scene/DriveBand";
import { StopBand } from "../stop/StopBand";
import { StopPlace } from "../stop/StopButton";
import { memoInLanguage } from "../texts/memoInLanguage";
import { type Phrase, t } from "../texts/text";
import { Parts } from "../ui/Parts";
import { ZonesPanel } from "../zones/ZonesPanel";
import classes from "./BottomPanel.module.css";
import type { Props as SideProps } from "./SidePanel";

interface Props extends SideProps {
  phone: boolean;
}

const LISTS = ["Places", "Missions", "Zones"] as const;
type List = (typeof LISTS)[number];
type Tab = "places" | "health" | "data";

const TABS: { key: Tab; label: Phrase; Icon: typeof IconHeartbeat }[] = [
  { key: "places", label: "Places", Icon: IconMapPins },
  { key: "health", label: "Health", Icon: IconHeartbeat },
  { key: "data", label: "Data", Icon: IconDatabase },
];

/**
 * What the right column is on a tablet or a phone: a sheet that opens from the bottom. On a phone
 * the rules cover the scene: what stops the robot is then told, and released, below them.
 */
export const BottomPanel = memoInLanguage(function BottomPanel({
  phone,
  onGo,
  asked,
  onDraw,
}: Props) {
  const rules = useNav();
  const [tab, setTab] = useState<Tab | null>(phone ? null : "health");
  const [list, setList] = useState<List>("Places");
  const [answered, setAnswered] = useState(asked);
  if (asked !== answered) {
    setAnswered(asked);
    setTab("places");
    setList("Places");
  }
  // On a phone the answer is shown where the list was.
  const go = (place: Place) => {
    if (phone) setTab(null);
    onGo?.(place);
  };
  const draw = (zone: Zone | null) => {
    setTab(null); // the floor, and the form that comes over it, need the room
    onDraw?.(zone);
  };
  const open = rules.open ? null : tab;
  const show = (next: Tab | null) => {
    rules.close();
    setTab(next);
  };
  return (
    <aside className={classes.bottom} aria-label={t("Robot")}>
      {open !== null && (
        <div className={classes.sheet} id="sheet">
          {open === "places" && (
            <>
              <SegmentedControl
                className={classes.switch}
                fullWidth
                aria-label={t("Places, missions or zones")}
                data={LISTS.map((each) => ({ value: each, label: t(each) }))}
                value={list}
                onChange={(shown) => setList(LISTS.find((each) => each === shown) ?? "Places")}
              />
              <Parts>
                {list === "Missions" && <MissionsPanel />}
                {list === "Zones" && <ZonesPanel onDraw={onDraw === null ? null : draw} />}
                {list === "Places" && (
                  <PlacesPanel
                    onGo={onGo === null ? null : go}
                    asked={asked}
                    deleted={MissionsTo}
                  />
                )}
              </Parts>
            </>
          )}
          {open === "health" && (
            <Parts>
              <HealthPanel />
              <LogPanel />
              <FiringsPanel />
            </Parts>
          )}
          {open === "data" && (
            <Parts>
              <DataPanel />
            </Parts>
          )}
        </div>
      )}
      {rules.open && (
        <div className={classes.rules} id="sheet">
          <Parts>
            <RulesSheet />
            {phone && (
              <div className={classes.bands}>
                <StopBand brief why={<StoppedByRule />} />
                <DriveBand />
              </div>
            )}
            <div className={classes.draft}>
              <DraftBar />
            </div>
          </Parts>
        </div>
      )}
      <div className={classes.bar}>
        <div className={classes.left}>
          <Parts>
            <MissionStatus brief={rules.open} />
            <GoalStatus />
          </Parts>
          <div className={classes.tabs}>
            {TABS.map(({ key, label, Icon }) => (
              <UnstyledButton
                key={key}
                className={classes.tab}
                aria-expanded={open === key}
                aria-controls="sheet"
                data-testid={`tab-${key}`}
                onClick={() => show(open === key ? null : key)}
              >
                <Icon size={20} aria-hidden />
                {t(label)}
              </UnstyledButton>
            ))}
            <UnstyledButton
              className={classes.tab}
              aria-expanded={rules.open}
              aria-controls="sheet"
              id={OPENERS.tab}
              data-testid="tab-rules"
              onClick={rules.toggle}
            >
              <IconBolt size={20} aria-hidden />
              {t("Rules")}
            </UnstyledButton>
          </div>
        </div>
        <StopPlace />
      </div>
    </aside>
  );
});
