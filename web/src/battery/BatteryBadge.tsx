import {
  IconBattery1,
  IconBattery2,
  IconBattery3,
  IconBattery4,
  IconBatteryCharging,
} from "@tabler/icons-react";
import { useRobot } from "../state/RobotContext";
import { t } from "../texts/text";
import classes from "./Battery.module.css";
import { batteryText, chargeText, isOld } from "./batteryText";

const ICONS = [IconBattery1, IconBattery2, IconBattery3, IconBattery4];

/** How full the battery is, where somebody tells. */
export function BatteryBadge() {
  const { state, elapsed } = useRobot();
  const battery = state?.battery ?? null;
  if (battery === null) return null;
  const step = Math.min(ICONS.length - 1, Math.floor(battery.charge * ICONS.length));
  const Icon = battery.charging ? IconBatteryCharging : (ICONS[step] ?? IconBattery1);
  const text = batteryText(battery, elapsed);
  return (
    <span
      className={classes.badge}
      title={text}
      data-low={(battery.low && !battery.charging) || undefined}
      data-stale={isOld(battery, elapsed) || undefined}
      data-testid="battery"
    >
      <Icon size={20} aria-hidden />
      <span className="visually-hidden">{battery.charging ? t("Charging") : t("Battery")} </span>
      {battery.low && !battery.charging && "▲ "}
      <span className={classes.charge}>{chargeText(battery)}</span>
    </span>
  );
}
