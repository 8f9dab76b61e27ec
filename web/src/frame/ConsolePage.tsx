import { useCallbackRef, useMediaQuery } from "@mantine/hooks";
import { type ComponentProps, useCallback, useEffect, useMemo, useState } from "react";
import type { GoalPick, Place, Zone } from "../api/types";
import { BatteryBand } from "../battery/BatteryBand";
import { CameraCorner } from "../camera/CameraCorner";
import { type CameraTool, useCameraTool } from "../camera/useCameraTool";
import { ControlBand } from "../control/ControlBand";
import { CoordinatesForm } from "../goal/CoordinatesForm";
import { GestureHint } from "../goal/GestureHint";
import { GestureOverlay, type PickOf } from "../goal/GestureOverlay";
import { GoalCard } from "../goal/GoalCard";
import { consideredOf, pointOf } from "../goal/onMap";
import { type GoalTool, useGoalTool } from "../goal/useGoalTool";
import { HandProvider, useHand } from "../hand/HandContext";
import { HandPanel } from "../hand/HandPanel";
import { useKeys } from "../keys";
import { LocateCard } from "../locate/LocateCard";
import { LocateHint } from "../locate/LocateHint";
import { consideredOf as locatedOn } from "../locate/onMap";
import { type LocateTool, useLocateTool } from "../locate/useLocateTool";
import { MeasureCard } from "../measure/MeasureCard";
import { type MeasureStroke, type MeasureTool, useMeasureTool } from "../measure/useMeasureTool";
import { NotifyProvider } from "../notify/Notifier";
import { usePlaces } from "../places/usePlaces";
import { AlarmsBand } from "../rules/bands/AlarmsBand";
import { ProbationBand } from "../rules/bands/ProbationBand";
import { StoppedByRule } from "../rules/bands/StoppedByRule";
import { RulesProvider } from "../rules/context/RulesContext";
import { RulesNavProvider, useNav } from "../rules/context/RulesNav";
import { CauseBand } from "../scene/CauseBand";
import { DriveBand } from "../scene/DriveBand";
import { FlatMap } from "../scene/flat/FlatMap";
import { PlayedBand } from "../scene/PlayedBand";
import scene from "../scene/Scene.module.css";
import { SceneFrame } from "../scene/SceneFrame";
import { StageProvider, useStage } from "../scene/StageContext";
import { StaleBand } from "../scene/StaleBand";
import { type Flat, useFlat } from "../scene/useFlat";
import { useView, type ViewHandle } from "../scene/useView";
import { useSession } from "../session/SessionContext";
import { RobotProvider } from "../state/RobotContext";
import { StopBand } from "../stop/StopBand";
import { StopButton } from "../stop/StopButton";
import { StopProvider } from "../stop/StopContext";
import { memoInLanguage } from "../texts/memoInLanguage";
import { t } from "../texts/text";
import { told } from "../texts/told";
import { Band } from "../ui/Band";
import { BandStack } from "../ui/BandStack";
import { Parts } from "../ui/Parts";
import { PHONE } from "../ui/screen";
import { useZones } from "../zones/useZones";
import { useZoneTool, type ZoneStroke, type ZoneTool } from "../zones/useZoneTool";
import { ZoneCard } from "../zones/ZoneCard";
import { asCorners, labelText } from "../zones/zoneText";
import { AuditBand } from "./AuditBand";
import { BottomPanel } from "./BottomPanel";
import classes from "./ConsolePage.module.css";
import { HelpPanel } from "./HelpPanel";
import { SidePanel } from "./SidePanel";
import { StatusLine } from "./StatusLine";
import { ToolRail } from "./ToolRail";
import { TopBar } from "./TopBar";
import { UpdateBand } from "./UpdateBand";
import { WebhookBand } from "./WebhookBand";

export function ConsolePage({ onRefused }: { onRefused: () => void }) {
  return (
    <RobotProvider onRefused={onRefused}>
      <NotifyProvider>
        <StopProvider>
          <RulesNavProvider>
            <RulesProvider>
              <HandProvider>
                <Workplace />
              </HandProvider>
            </RulesProvider>
          </RulesNavProvider>
        </StopProvider>
      </NotifyProvider>
    </RobotProvider>
  );
}

/** The page around its scene. */
function Workplace() {
  const handle = useView();
  const rules = useNav();
  const phone = useMediaQuery(PHONE, false, { getInitialValueInEffect: false });
  const covered = phone && rules.open;
  const flat = useFlat();
  return (
    <StageProvider view={handle.view?.id ?? null} ready={!flat.flat && !covered}>
      <Frame handle={handle} phone={phone} flat={flat} />
    </StageProvider>
  );
}

/** The frame of the page. Robot data is read by its leaves: nothing here renders with it. */
function Frame({ handle, phone, flat }: { handle: ViewHandle; phone: boolean; flat: Flat }) {
  const { session } = useSession();
  const { view, change } = handle;
  const goal = useGoalTool(view?.id ?? null);
  const locate = useLocateTool(view?.id ?? null);
  const zone = useZoneTool(view?.id ?? null);
  const measure = useMeasureTool(view?.id ?? null);
  const rules = useNav();
  const stage = useStage();
  const plays = stage.shown !== null;
  const hand = useHand();
  const camera = useCameraTool();
  const [layersOpen, setLayersOpen] = useState(false);
  const [helpOpen, setHelpOpen] = useState(false);
  const [placesAsked, setPlacesAsked] = useState(0);
  const narrow = useMediaQuery("(max-width: 1100px)", false, { getInitialValueInEffect: false });
  // What is pressed in a drill's world is no place of the robot's.
  useEffect(() => {
    if (plays && goal.active) goal.toggle();
    if (plays && locate.active) locate.toggle();
  }, [plays, goal.active, goal.toggle, locate.active, locate.toggle]);
  useEffect(() => {
    if (plays && zone.active) zone.leave();
    if (plays && measure.active) measure.toggle();
  }, [plays, zone.active, zone.leave, measure.active, measure.toggle]);
  // Nobody drives what is not seen: a drill in the robot's place, or rules in that of the page.
  const unseen = plays || (phone && rules.open);
  useEffect(() => {
    if (unseen) hand.close();
  }, [unseen, hand.close]);

  // One gesture means one thing.
  const toggleGoal = useCallbackRef(() => {
    if (locate.active) locate.toggle();
    if (zone.active) zone.leave();
    if (measure.active) measure.toggle();
    goal.toggle();
  });
  const toggleLocate = useCallbackRef(() => {
    if (goal.active) goal.toggle();
    else if (goal.draft !== null) goal.drop(); // of a place of the list
    if (zone.active) zone.leave();
    if (measure.active) measure.toggle();
    locate.toggle();
  });
  const toggleMeasure = useCallbackRef(() => {
    if (goal.active) goal.toggle();
    else if (goal.draft !== null) goal.drop();
    if (locate.active) locate.toggle();
    if (zone.active) zone.leave();
    measure.toggle();
  });
  const drawZone = useCallbackRef((before: Zone | null) => {
    if (goal.active) goal.toggle();
    else if (goal.draft !== null) goal.drop();
    if (locate.active) locate.toggle();
    if (measure.active) measure.toggle();
    zone.begin(before);
  });

  useKeys(({ key, onControl, inMenu }) => {
    switch (key.toLowerCase()) {
      case "g":
        if (session.role !== "viewer" && view !== null && !plays) toggleGoal();
        return true;
      case "o":
        if (session.role !== "viewer" && view !== null && !plays) toggleLocate();
        return true;
      case "m":
        if (view !== null && !plays) toggleMeasure();
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
        if (view !== null && !flat.flat) change({ top: !view.top });
        return true;
      case "l":
        setLayersOpen(!layersOpen);
        return true;
      case "c":
        camera.toggle();
        return true;
      case "r":
        // The timeline has a key of its own.
        if (rules.place.at === "timeline") rules.go({ at: "table" });
        else rules.toggle();
        return true;
      case "e":
        if (rules.open && rules.place.at === "timeline") rules.close();
        else rules.go({ at: "timeline" });
        return true;
      case "p":
        rules.close();
        setPlacesAsked(placesAsked + 1);
        return true;
      case "?":
      case "h":
        setHelpOpen(!helpOpen);
        return true;
      case "enter":
        // A focused button knows best what Enter means.
        if (onControl) return false;
        if (goal.draft !== null) goal.go();
        else if (locate.draft?.check?.note === "") locate.set();
        else return false;
        return true;
      case "escape":
        if (inMenu) return false;
        if (layersOpen || helpOpen) {
          // What lies over the page goes before the wheel, which a hand that lets go has left.
          if (layersOpen) setLayersOpen(false);
          else setHelpOpen(false);
          return true;
        }
        if (hand.yours) {
          hand.give();
          return true;
        }
        if (goal.back() || locate.back() || zone.back() || measure.back()) return true;
        if (camera.back()) return true;
        if (hand.open) hand.close();
        else if (plays) stage.leave();
        else if (rules.open) {
          if (!rules.back()) rules.close();
        } else return false;
        return true;
      default:
        return false;
    }
  });

  const checkPlace = useCallbackRef((place: Place) => {
    if (locate.active) locate.toggle();
    if (zone.active) zone.leave();
    if (measure.active) measure.toggle();
    goal.checkPlace(place);
  });
  const toggleHelp = useCallback(() => setHelpOpen((open) => !open), []);
  const tools = useMemo(
    () => ({
      goal: { active: goal.active, toggle: toggleGoal },
      locate: { active: locate.active, toggle: toggleLocate },
      measure: { active: measure.active, toggle: toggleMeasure },
    }),
    [goal.active, locate.active, measure.active, toggleGoal, toggleLocate, toggleMeasure],
  );
  // A zone that is drawn is not lost by a press beside it.
  const drawing = zone.active && zone.corners.length > 0;
  const goTo = view === null || plays || drawing ? null : checkPlace;
  const onDraw = view === null || plays ? null : drawZone;
  return (
    <>
      <div className={classes.page} data-rules={rules.open || undefined}>
        <Parts>
          <TopBar onHelp={toggleHelp} />
          <main className={scene.scene}>
            <Parts>
              <SceneStack
                handle={handle}
                goal={goal}
                locate={locate}
                zone={zone}
                measure={measure}
                camera={camera}
                flat={flat.flat}
                covered={phone && rules.open}
                onGo={goTo}
              />
              {helpOpen && <HelpPanel onClose={() => setHelpOpen(false)} />}
            </Parts>
          </main>
          <ToolRail
            scene={handle}
            flat={flat}
            tools={tools}
            layersOpen={layersOpen}
            onLayers={setLayersOpen}
            helpOpen={helpOpen}
            onHelp={toggleHelp}
          />
          <HandPanel />
          <StatusLine />
          {narrow ? (
            <BottomPanel phone={phone} onGo={goTo} asked={placesAsked} onDraw={onDraw} />
          ) : (
            <SidePanel onGo={goTo} asked={placesAsked} onDraw={onDraw} />
          )}
        </Parts>
      </div>
      <StopButton />
    </>
  );
}

/** The scene, and what lies over it, from far to near. */
function SceneStack({
  handle,
  goal,
  locate,
  zone,
  measure,
  camera,
  flat,
  covered,
  onGo,
}: {
  handle: ViewHandle;
  goal: GoalTool;
  locate: LocateTool;
  zone: ZoneTool;
  measure: MeasureTool;
  camera: CameraTool;
  flat: boolean;
  covered: boolean;
  onGo: ((place: Place) => void) | null;
}) {
  const { view, error } = handle;
  const considered = locate.active
    ? locatedOn(locate.draft)
    : consideredOf(goal.draft?.check ?? null);
  const gestures = (pick: PickOf) => (
    <>
      {goal.active && (
        <GestureOverlay
          name="goal"
          pick={pick}
          waits={goal.draft?.phase === "checking"}
          onPick={goal.check}
        />
      )}
      {locate.active && (
        <GestureOverlay
          name="locate"
          pick={pick}
          waits={locate.draft?.phase === "checking"}
          onPick={locate.check}
          onDrag={locate.look}
        />
      )}
    </>
  );
  const drawing = (
    pick: (start: Fractions, end: Fractions | null) => GoalPick | ZoneStroke | MeasureStroke,
  ) => (
    <>
      {zone.active && (
        <GestureOverlay name="zone" pick={pick} waits={zone.problem === null} onPick={zone.draw} />
      )}
      {measure.active && (
        <GestureOverlay name="measure" pick={pick} waits={measure.waits} onPick={measure.draw} />
      )}
    </>
  );
  return (
    <>
      {view === null ? (
        <p className={scene.waiting}>
          {error === null ? t("Opening the scene…") : `${told(error.title)} ${told(error.remedy)}`}
        </p>
      ) : (
        <>
          {flat ? (
            <FlatScene
              handle={handle}
              considered={considered}
              sketch={zone.corners}
              measured={measure.points}
            >
              {(floorAt) => (
                <>
                  {gestures((start, end) => ({
                    ...pointOf(floorAt(start), end === null ? null : floorAt(end)),
                    view: view.id,
                  }))}
                  {drawing((start, end) => ({
                    from: floorAt(start),
                    to: end === null ? null : floorAt(end),
                  }))}
                </>
              )}
            </FlatScene>
          ) : (
            <>
              <SceneFrame id={view.id} />
              {gestures((start, end) => ({ view: view.id, start, end }))}
              {drawing((start, end) => ({ view: view.id, start, end }))}
            </>
          )}
          {goal.active && goal.draft === null && (
            <GestureHint name="goal" tool={goal}>
              <span>{t("Tap the floor, or press, drag to the heading and release.")}</span>
            </GestureHint>
          )}
          {goal.active && goal.typing && goal.draft === null && (
            <CoordinatesForm label={t("Goal coordinates")} tool={goal} view={view.id} />
          )}
          {goal.draft !== null && <GoalCard tool={goal} draft={goal.draft} />}
          {locate.active && locate.draft === null && <LocateHint tool={locate} />}
          {locate.active && locate.typing && locate.draft === null && (
            <CoordinatesForm label={t("Coordinates of the robot")} tool={locate} view={view.id} />
          )}
          {measure.active && <MeasureCard tool={measure} />}
          {zone.active && <ZoneCard key={zone.zone?.id ?? 0} tool={zone} />}
          {locate.draft !== null && <LocateCard tool={locate} draft={locate.draft} />}
        </>
      )}
      <Parts>
        <CameraCorner tool={camera} covered={covered} />
        <Bands covered={covered} onGo={onGo} error={view === null ? null : error} />
      </Parts>
    </>
  );
}

interface BandsProps {
  /** The scene is covered, and tells these above what covers it. */
  covered: boolean;
  onGo: ((place: Place) => void) | null;
  error: ViewHandle["error"];
}

/** What is to be known at once, the gravest first. */
const Bands = memoInLanguage(function Bands({ covered, onGo, error }: BandsProps) {
  const { open: rulesOpen } = useNav();
  return (
    <div className={scene.bands}>
      <BandStack>
        {!covered && <StopBand why={<StoppedByRule />} />}
        <PlayedBand />
        {!covered && <DriveBand />}
        <StaleBand />
        <ControlBand />
        <CauseBand />
        <AlarmsBand />
        <BatteryBand onGo={onGo} />
        {!rulesOpen && <ProbationBand />}
        {error !== null && (
          <Band tone="notice" title={told(error.title)} testId="view-error">
            {told(error.remedy)}
          </Band>
        )}
        <AuditBand />
        <WebhookBand />
        <UpdateBand />
      </BandStack>
    </div>
  );
});

type Fractions = [number, number];

function FlatScene(props: Omit<ComponentProps<typeof FlatMap>, "places" | "zones">) {
  const { list } = usePlaces();
  const { list: zones } = useZones();
  const here = list?.places.filter((place) => place.here) ?? [];
  const drawn = zones?.zones.filter((zone) => zone.here) ?? [];
  const masks = zones?.masks ?? [];
  return (
    <FlatMap
      {...props}
      places={here.map(({ name, pose }) => ({ name, ...pose }))}
      zones={[...drawn, ...masks].map((zone) => ({
        label: labelText(zone),
        barred: zone.kind === "keep_out",
        corners: asCorners(zone.corners),
      }))}
    />
  );
}
