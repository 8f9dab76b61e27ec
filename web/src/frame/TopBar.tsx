import { ActionIcon, Menu, UnstyledButton } from "@mantine/core";
import { useMediaQuery } from "@mantine/hooks";
import {
  IconBell,
  IconChevronDown,
  IconDevicesOff,
  IconHelpCircle,
  IconLanguage,
  IconLogout,
  IconMoon,
  IconRulerMeasure,
  IconSun,
  IconSunMoon,
  IconUser,
} from "@tabler/icons-react";
import { useMutation } from "@tanstack/react-query";
import { useCallback, useState } from "react";
import { logoutOthers } from "../api/client";
import { BatteryBadge } from "../battery/BatteryBadge";
import { batteryText } from "../battery/batteryText";
import { ControlBadge } from "../control/ControlBadge";
import { fixed } from "../format";
import { DrivenBy } from "../hand/DrivenBy";
import { NotifyDialog } from "../notify/NotifyDialog";
import { RevisionBadge } from "../rules/bands/RevisionBadge";
import { useSession } from "../session/SessionContext";
import { lastRestart } from "../state/causes";
import { overall } from "../state/overall";
import { useRobot } from "../state/RobotContext";
import { useStop } from "../stop/StopContext";
import { LANGUAGE_KEYS, LANGUAGES, language } from "../texts/language";
import { memoInLanguage } from "../texts/memoInLanguage";
import { t } from "../texts/text";
import { told } from "../texts/told";
import { UNITS, units } from "../texts/units";
import { Mark } from "../ui/Mark";
import { StatusMark } from "../ui/StatusMark";
import { PHONE } from "../ui/screen";
import { useTheme } from "../ui/theme";
import classes from "./TopBar.module.css";

export const TopBar = memoInLanguage(function TopBar({ onHelp }: { onHelp: () => void }) {
  const phone = useMediaQuery(PHONE, false, { getInitialValueInEffect: false });
  const [notify, setNotify] = useState(false);
  const openNotify = useCallback(() => setNotify(true), []);
  return (
    <header className={classes.bar}>
      <span className={classes.robot}>
        <Mark size={22} />
        <RobotName />
      </span>
      <OverallState />
      <span className={classes.gap} />
      <ControlBadge />
      {/* On a phone both are in the menu, for the robot's name needs the room; a low battery has a band. */}
      {!phone && <BatteryBadge />}
      <RevisionBadge />
      <SimulationRate />
      {!phone && <ThemeToggle />}
      <UserMenu onNotify={openNotify} onHelp={onHelp} />
      <NotifyDialog opened={notify} onClose={() => setNotify(false)} />
    </header>
  );
});

function RobotName() {
  const { state } = useRobot();
  return <strong>{state?.robot.name ?? "Kompass Console"}</strong>;
}

function OverallState() {
  const { state, elapsed, cause } = useRobot();
  const { stop, drive } = useStop();
  const wasStopped = drive === null && state?.drive?.stopped === true;
  const { level, text } = overall(state, elapsed, cause, lastRestart(state));
  return (
    <span className={classes.states}>
      <span className={classes.state} data-level={level} data-testid="overall" role="status">
        <StatusMark level={level} />
        <span className={classes.what}>{text}</span>
      </span>
      {(drive?.stopped || wasStopped) && (
        <span
          className={classes.stopped}
          data-stale={wasStopped || undefined}
          data-testid="stopped-hint"
        >
          {wasStopped ? t("Was stopped") : stop.phase === "stopped" ? t("Stopped") : t("Stopping")}
        </span>
      )}
      <DrivenBy place="bar" />
    </span>
  );
}

/** A simulation should never be taken for the robot, nor its clock for the wall's. */
function SimulationRate() {
  const { state, elapsed } = useRobot();
  const simulation = state?.simulation ?? null;
  if (simulation === null) return null;
  const stale = simulation.age + elapsed > 3;
  return (
    <span
      className={classes.sim}
      data-testid="sim-rate"
      data-stale={stale || undefined}
      title={t("Simulated seconds per second")}
    >
      <span className={classes.simLong}>{t("Simulation")} </span>
      <span className={classes.simShort}>{t("Sim")} </span>
      {stale ? t("silent") : <span className={classes.rate}>{fixed(simulation.rate, 2)}×</span>}
    </span>
  );
}

const THEME_WORDS = {
  auto: "Theme: as the system",
  light: "Theme: light",
  dark: "Theme: dark",
} as const;

function useThemeWords() {
  const { choice, cycle } = useTheme();
  const Icon = { auto: IconSunMoon, light: IconSun, dark: IconMoon }[choice];
  return { label: t(THEME_WORDS[choice]), Icon, cycle };
}

const ThemeToggle = memoInLanguage(function ThemeToggle() {
  const { label, Icon, cycle } = useThemeWords();
  return (
    <ActionIcon
      variant="subtle"
      color="gray"
      className={classes.icon}
      aria-label={label}
      title={label}
      data-testid="theme-toggle"
      onClick={cycle}
    >
      <Icon size={20} aria-hidden />
    </ActionIcon>
  );
});

const UserMenu = memoInLanguage(function UserMenu({
  onNotify,
  onHelp,
}: {
  onNotify: () => void;
  onHelp: () => void;
}) {
  const { session, logout } = useSession();
  const theme = useThemeWords();
  const phone = useMediaQuery(PHONE, false, { getInitialValueInEffect: false });
  const others = useMutation({ mutationFn: logoutOthers });
  return (
    <Menu position="bottom-end" width={240} onOpen={others.reset}>
      <Menu.Target>
        <UnstyledButton
          className={classes.user}
          aria-label={t("User {user}", { user: session.user })}
          data-testid="user-menu"
        >
          <IconUser size={18} aria-hidden />
          <span className={classes.userName}>{session.user}</span>
          <IconChevronDown className={classes.more} size={14} aria-hidden />
        </UnstyledButton>
      </Menu.Target>
      <Menu.Dropdown>
        <Menu.Label>
          {session.user}, {t(session.role)}
        </Menu.Label>
        <RobotFacts />
        {phone && (
          <Menu.Item
            closeMenuOnClick={false}
            leftSection={<theme.Icon size={18} aria-hidden />}
            onClick={theme.cycle}
            mih={44}
            data-testid="theme-item"
          >
            {theme.label}
          </Menu.Item>
        )}
        {phone && (
          <Menu.Item
            leftSection={<IconHelpCircle size={18} aria-hidden />}
            onClick={onHelp}
            mih={44}
            data-testid="help-item"
          >
            {t("Keys and gestures")}
          </Menu.Item>
        )}
        <Menu.Divider />
        <LanguageItems />
        <Menu.Item
          leftSection={<IconBell size={18} aria-hidden />}
          onClick={onNotify}
          mih={44}
          data-testid="notify-item"
        >
          {t("Notifications")}
        </Menu.Item>
        {session.account && (
          <Menu.Item
            closeMenuOnClick={false}
            leftSection={<IconDevicesOff size={18} aria-hidden />}
            onClick={() => others.mutate()}
            disabled={others.isPending || others.isSuccess}
            mih={44}
            data-testid="logout-others"
          >
            {others.isSuccess ? t("Logged out elsewhere") : t("Log out elsewhere")}
          </Menu.Item>
        )}
        {others.error !== null && (
          <Menu.Label role="alert">
            {told(others.error.title)} {told(others.error.remedy)}
          </Menu.Label>
        )}
        <Menu.Item
          leftSection={<IconLogout size={18} aria-hidden />}
          onClick={logout}
          mih={44}
          data-testid="logout"
        >
          {t("Log out")}
        </Menu.Item>
      </Menu.Dropdown>
    </Menu>
  );
});

/** What the menu tells of the robot; made while it is open only. */
function RobotFacts() {
  const { version, state, elapsed } = useRobot();
  return (
    <>
      {state?.simulation && (
        <Menu.Label>
          {t("Simulation at {rate}×", { rate: fixed(state.simulation.rate, 2) })}
        </Menu.Label>
      )}
      {state?.battery && <Menu.Label>{batteryText(state.battery, elapsed)}</Menu.Label>}
      {version !== null && <Menu.Label>Kompass Console {version}</Menu.Label>}
      {state !== null && (
        <Menu.Label>
          {t("ROS domain {domain}, {middleware}", {
            domain: state.ros.domain_id,
            middleware: state.ros.middleware,
          })}
        </Menu.Label>
      )}
    </>
  );
}

const UNIT_WORDS = {
  metric: "Units: metric (m)",
  imperial: "Units: imperial (ft)",
} as const;

const after = <Value,>(now: Value, all: readonly Value[]): Value =>
  all[(all.indexOf(now) + 1) % all.length] ?? now;

/** The language of the page, named in itself, and its units: each press takes the next. */
function LanguageItems() {
  const speaks = language.use();
  const measures = units.use();
  return (
    <>
      <Menu.Item
        closeMenuOnClick={false}
        leftSection={<IconLanguage size={18} aria-hidden />}
        onClick={() => language.choose(after(speaks, LANGUAGE_KEYS))}
        mih={44}
        data-testid="language-item"
      >
        {t("Language: {name}", { name: LANGUAGES[speaks] })}
      </Menu.Item>
      <Menu.Item
        closeMenuOnClick={false}
        leftSection={<IconRulerMeasure size={18} aria-hidden />}
        onClick={() => units.choose(after(measures, UNITS))}
        mih={44}
        data-testid="units-item"
      >
        {t(UNIT_WORDS[measures])}
      </Menu.Item>
    </>
  );
}
