import { useMediaQuery } from "@mantine/hooks";
import { useEffect, useState } from "react";
import { CoordinatesForm } from "../goal/CoordinatesForm";
import { GoalCard } from "../goal/GoalCard";
import { GoalHint } from "../goal/GoalHint";
import { GoalOverlay } from "../goal/GoalOverlay";
import { type GoalTool, useGoalTool } from "../goal/useGoalTool";
import { HandProvider, useHand } from "../hand/HandContext";
import { HandPanel } from "../hand/HandPanel";
import { useKeys } from "../keys";
import { AlarmsBand } from "../rules/bands/AlarmsBand";
import { ProbationBand } from "../rules/bands/ProbationBand";
import { StoppedByRule } from "../rules/bands/StoppedByRule";
import { RulesProvider } from "../rules/context/RulesContext";
import { RulesNavProvider, useNav } from "../rules/context/RulesNav";
import { CauseBand } from "../scene/CauseBand";
import { DriveBand } from "../scene/DriveBand";
import { PlayedBand } from "../scene/PlayedBand";
import scene from "../scene/Scene.module.css";
import { SceneFrame } from "../scene/SceneFrame";
import { StageProvider, useStage } from "../scene/StageContext";
import { StaleBand } from "../scene/StaleBand";
import { useView, type ViewHandle } from "../scene/useView";
import { drawsWebGl } from "../scene/webgl";
import { useSession } from "../session/SessionContext";
import { RobotProvider } from "../state/RobotContext";
import { StopBand } from "../stop/StopBand";
import { StopButton } from "../stop/StopButton";
import { StopProvider } from "../stop/StopContext";
import { Band } from "../ui/Band";
import { PHONE } from "../ui/screen";
import { AuditBand } from "./AuditBand";
import { BottomPanel } from "./BottomPanel";
import classes from "./ConsolePage.module.css";
import { HelpPanel } from "./HelpPanel";
import { SidePanel } from "./SidePanel";
import { StatusLine } from "./StatusLine";
import { ToolRail } from "./ToolRail";
import { TopBar } from "./TopBar";

export function ConsolePage({ onRefused }: { onRefused: () => void }) {
  return (
    <RobotProvider onRefused={onRefused}>
      <StopProvider>
        <RulesNavProvider>
          <RulesProvider>
            <HandProvider>
              <Workplace />
            </HandProvider>
          </RulesProvider>
        </RulesNavProvider>
      </StopProvider>
    </RobotProvider>
  );
}

/** The page around its scene. */
function Workplace() {
  const handle = useView();
  const rules = useNav();
  const phone = useMediaQuery(PHONE, false, { getInitialValueInEffect: false });
  const covered = phone && rules.open;
  return (
    <StageProvider view={handle.view?.id ?? null} ready={drawsWebGl() && !covered}>
      <Frame handle={handle} phone={phone} />
    </StageProvider>
  );
}

/** The frame of the page. Robot data is read by its leaves: nothing here renders with it. */
function Frame({ handle, phone }: { handle: ViewHandle; phone: boolean }) {
  const { session } = useSession();
  const { view, change } = handle;
  const goal = useGoalTool(view?.id ?? null);
  const rules = useNav();
  const stage = useStage();
  const plays = stage.shown !== null;
  const hand = useHand();
  const [layersOpen, setLayersOpen] = useState(false);
  const [helpOpen, setHelpOpen] = useState(false);
  const narrow = useMediaQuery("(max-width: 1100px)", false, { getInitialValueInEffect: false });
  // What is pressed in a drill's world is no place of the robot's.
  useEffect(() => {
    if (plays && goal.active) goal.toggle();
  }, [plays, goal.active, goal.toggle]);
  // Nobody drives what is not seen: a drill in the robot's place, or rules in that of the page.
  const unseen = plays || (phone && rules.open);
  useEffect(() => {
    if (unseen) hand.close();
  }, [unseen, hand.close]);

  useKeys(({ key, onControl, inMenu }) => {
    switch (key.toLowerCase()) {
      case "g":
        if (session.role !== "viewer" && view !== null && !plays) goal.toggle();
        return true;
      case "f":
        if (view !== null && !plays) change({ follow: !view.follow });
        return true;
      case "d":
        // At the wheel it is a turn to the right.
        if (hand.yours) return false;
        if (session.role !== "viewer" && !unseen) hand.toggle();
        return true;
      case "t":
        if (view !== null) change({ top: !view.top });
        return true;
      case "l":
        setLayersOpen(!layersOpen);
        return true;
      case "r":
        rules.toggle();
        return true;
      case "?":
      case "h":
        setHelpOpen(!helpOpen);
        return true;
      case "enter":
        // A focused button knows best what Enter means.
        if (onControl || goal.draft === null) return false;
        goal.go();
        return true;
      case "escape":
        if (inMenu || layersOpen) return false;
        if (hand.yours) {
          hand.give();
          return true;
        }
        if (goal.back()) return true;
        if (helpOpen) setHelpOpen(false);
        else if (hand.open) hand.close();
        else if (plays) stage.leave();
        else if (rules.open) {
          if (!rules.back()) rules.close();
        } else return false;
        return true;
      default:
        return false;
    }
  });

  return (
    <>
      <div className={classes.page} data-rules={rules.open || undefined}>
        <TopBar />
        <main className={scene.scene}>
          <SceneStack handle={handle} goal={goal} covered={phone && rules.open} />
          {helpOpen && <HelpPanel onClose={() => setHelpOpen(false)} />}
        </main>
        <ToolRail
          scene={handle}
          goal={goal}
          layersOpen={layersOpen}
          onLayers={setLayersOpen}
          helpOpen={helpOpen}
          onHelp={() => setHelpOpen(!helpOpen)}
        />
        <HandPanel />
        <StatusLine />
        {narrow ? <BottomPanel phone={phone} /> : <SidePanel />}
      </div>
      <StopButton />
    </>
  );
}

/** The scene, and what lies over it, from far to near. */
function SceneStack({
  handle,
  goal,
  covered,
}: {
  handle: ViewHandle;
  goal: GoalTool;
  covered: boolean;
}) {
  const { view, error } = handle;
  const { open: rulesOpen } = useNav();
  return (
    <>
      {view === null ? (
        <p className={scene.waiting}>
          {error === null ? "Opening the scene…" : `${error.title} ${error.remedy}`}
        </p>
      ) : (
        <>
          <SceneFrame id={view.id} />
          {goal.active && drawsWebGl() && <GoalOverlay tool={goal} view={view.id} />}
          {goal.active && goal.draft === null && <GoalHint tool={goal} />}
          {goal.active && goal.typing && goal.draft === null && (
            <CoordinatesForm tool={goal} view={view.id} />
          )}
          {goal.draft !== null && <GoalCard tool={goal} draft={goal.draft} />}
        </>
      )}
      <div className={scene.bands}>
        {!covered && <StopBand why={<StoppedByRule />} />}
        <PlayedBand />
        <CauseBand />
        <StaleBand />
        {!covered && <DriveBand />}
        <AuditBand />
        <AlarmsBand />
        {!rulesOpen && <ProbationBand />}
        {view !== null && error !== null && (
          <Band tone="notice" title={error.title} testId="view-error">
            {error.remedy}
          </Band>
        )}
      </div>
    </>
  );
}
