import { expect, test } from "vitest";
import { type Battery, batteryText, chargeText } from "./batteryText";

const BATTERY: Battery = {
  charge: 0.6199,
  charging: false,
  low: false,
  voltage: 11.8,
  topic: "/battery_state",
  age: 1,
};

test("nobody is told of more charge than there is", () => {
  expect(chargeText(BATTERY)).toBe("61 %");
  expect(chargeText({ ...BATTERY, charge: 1 })).toBe("100 %");
});

test("what is known of it is told, with its age when that is old", () => {
  expect(batteryText(BATTERY, 0)).toBe("Battery 61 %, 11.8 V");
  expect(batteryText({ ...BATTERY, charging: true, voltage: null }, 60)).toBe(
    "Battery 61 %, charging, as told 1 min ago",
  );
});
