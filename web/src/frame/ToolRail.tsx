import { UnstyledButton } from "@mantine/core";
import {
  IconBolt,
  IconCurrentLocation,
  IconHelpCircle,
  IconMapPin,
  IconMapPinQuestion,
  IconRuler2,
  IconSquareArrowDown,
  IconSteeringWheel,
  IconTimelineEvent,
} from "@tabler/icons-react";
import type { ReactNode } from "react";
import { useHand } from "../hand/HandContext";
import { OPENERS, useNav } from "../rules/context/RulesNav";
import { LayersMenu } from "../scene/LayersMenu";
import { useStage } from "../scene/StageContext";
import type { Flat } from "../scene/useFlat";
import type { ViewHandle } from "../scene/useView";
import { useSession } from "../session/SessionContext";
import { memoInLanguage } from "../texts/memoInLanguage";
import { t } from "../texts/text";
import classes from "./ToolRail.module.css";

interface Switch {
  active: boolean;
  toggle: () => void;
}

interface Props {
  scene: ViewHandle;
  flat: Flat;
  /** What is done on the floor. */
  tools: { goal: Switch; locate: Switch; measure: Switch };
  layersOpen: boolean;
  onLayers: (open: boolean) => void;
  helpOpen: boolean;
  onHelp: () => void;
}

export const ToolRail = memoInLanguage(function ToolRail(props: Props) {
  const { scene, flat, tools, layersOpen, onLayers, helpOpen, onHelp } = props;
  const { goal, locate, measure } = tools;
  const { session } = useSession();
  const { view, change } = scene;
  const rules = useNav();
  const timeline = rules.open && rules.place.at === "timeline";
  const hand = useHand();
  const viewer = session.role === "viewer";
  const plays = useStage().shown !== null;
  const later = t("Go back to the robot first");
  return (
    <nav className={classes.rail} aria-label={t("Tools")}>
      <Tool
        testId="goal-tool"
        label={t("Goal")}
        hint={
          viewer
            ? t("Viewers watch; an operator sends goals")
            : plays
              ? later
              : t("Send the robot somewhere (G)")
        }
        on={goal.active}
        disabled={viewer || view === null || plays}
        onClick={goal.toggle}
        icon={<IconMapPin size={22} aria-hidden />}
      />
      <Tool
        testId="hand-tool"
        label={t("Drive")}
        hint={
          viewer ? t("Viewers watch; an operator drives") : plays ? later : t("Drive by hand (D)")
        }
        on={hand.open}
        disabled={viewer || plays}
        onClick={hand.toggle}
        icon={<IconSteeringWheel size={22} aria-hidden />}
      />
      <Tool
        testId="locate-tool"
        label={t("Locate")}
        hint={
          viewer
            ? t("Viewers watch; an operator says where the robot is")
            : plays
              ? later
              : t("Say where the robot is (O)")
        }
        on={locate.active}
        disabled={viewer || view === null || plays}
        onClick={locate.toggle}
        icon={<IconMapPinQuestion size={22} aria-hidden />}
      />
      <Tool
        testId="measure-tool"
        label={t("Measure")}
        hint={plays ? later : t("How far it is from one point to another (M)")}
        on={measure.active}
        disabled={view === null || plays}
        onClick={measure.toggle}
        icon={<IconRuler2 size={22} aria-hidden />}
      />
      <LayersMenu
        scene={scene}
        flat={flat}
        open={layersOpen}
        onOpen={onLayers}
        className={classes.tool}
      />
      <Tool
        testId="follow"
        label={t("Follow")}
        hint={plays ? later : t("Keep the robot in the middle (F)")}
        on={view?.follow ?? false}
        disabled={view === null || plays}
        onClick={() => view !== null && change({ follow: !view.follow })}
        icon={<IconCurrentLocation size={22} aria-hidden />}
      />
      <Tool
        testId="top-view"
        label={t("Top view")}
        hint={flat.flat ? t("A flat map is seen from above") : t("Look straight down (T)")}
        on={flat.flat || (view?.top ?? false)}
        disabled={view === null || flat.flat}
        onClick={() => view !== null && change({ top: !view.top })}
        icon={<IconSquareArrowDown size={22} aria-hidden />}
      />
      <Tool
        testId="rules"
        id={OPENERS.rail}
        label={t("Rules")}
        hint={t("What the robot does when something happens (R)")}
        wide
        on={rules.open && !timeline}
        onClick={() => (timeline ? rules.go({ at: "table" }) : rules.toggle())}
        icon={<IconBolt size={22} aria-hidden />}
      />
      <Tool
        testId="timeline-tool"
        label={t("Timeline")}
        hint={t("What has happened (E)")}
        wide
        on={timeline}
        onClick={() => (timeline ? rules.close() : rules.go({ at: "timeline" }))}
        icon={<IconTimelineEvent size={22} aria-hidden />}
      />
      <Tool
        testId="help"
        label={t("Help")}
        hint={t("Keys and gestures (?)")}
        roomy
        on={helpOpen}
        onClick={onHelp}
        icon={<IconHelpCircle size={22} aria-hidden />}
      />
    </nav>
  );
});

interface ToolProps {
  testId: string;
  id?: string;
  label: string;
  hint: string;
  on: boolean;
  disabled?: boolean;
  /** Only where there is room beside the scene; elsewhere it is a tab of the sheet. */
  wide?: boolean;
  /** On a phone it is in the menu. */
  roomy?: boolean;
  onClick: () => void;
  icon: ReactNode;
}

function Tool(props: ToolProps) {
  const {
    testId,
    id,
    label,
    hint,
    on,
    disabled = false,
    wide = false,
    roomy = false,
    onClick,
    icon,
  } = props;
  return (
    <UnstyledButton
      className={classes.tool}
      id={id}
      data-testid={testId}
      data-wide={wide || undefined}
      data-roomy={roomy || undefined}
      aria-pressed={on}
      title={hint}
      disabled={disabled}
      onClick={onClick}
    >
      {icon}
      <span>{label}</span>
    </UnstyledButton>
  );
}
