import type { State } from "../api/types";
import { ageText } from "../format";

export type Battery = NonNullable<State["battery"]>;

/** A charge that is older than this may be another one by now, s. */
const OLD_S = 30;

/** Whole percents, rounded down: nobody is told of more than there is. */
export const chargeText = (battery: Battery): string => `${Math.floor(100 * battery.charge)} %`;

/** All that is known of it, for whoever points at it. */
export function batteryText(battery: Battery, elapsed: number): string {
  const parts = [`Battery ${chargeText(battery)}`];
  if (battery.charging) parts.push("charging");
  if (battery.voltage !== null) parts.push(`${battery.voltage.toFixed(1)} V`);
  const age = battery.age + elapsed;
  if (isOld(battery, elapsed)) parts.push(`as told ${ageText(age)} ago`);
  return parts.join(", ");
}

export const isOld = (battery: Battery, elapsed: number): boolean => battery.age + elapsed > OLD_S;
