import type { State } from "../api/types";
import { ageText, fixed } from "../format";
import { t } from "../texts/text";

export type Battery = NonNullable<State["battery"]>;

/** A charge that is older than this may be another one by now, s. */
const OLD_S = 30;

/** Whole percents, rounded down: nobody is told of more than there is. */
export const chargeText = (battery: Battery): string => `${Math.floor(100 * battery.charge)} %`;

/** All that is known of it, for whoever points at it. */
export function batteryText(battery: Battery, elapsed: number): string {
  const parts = [t("Battery {charge}", { charge: chargeText(battery) })];
  if (battery.charging) parts.push(t("charging"));
  if (battery.voltage !== null) parts.push(`${fixed(battery.voltage, 1)} V`);
  const age = battery.age + elapsed;
  if (isOld(battery, elapsed)) parts.push(t("as told {age} ago", { age: ageText(age) }));
  return parts.join(", ");
}

export const isOld = (battery: Battery, elapsed: number): boolean => battery.age + elapsed > OLD_S;
