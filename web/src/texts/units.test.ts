import { afterEach, describe, expect, test } from "vitest";
import { distanceText, fixed, pointText, signed, speedText } from "../format";
import { parseCoordinates } from "../goal/coordinates";
import { lengthText } from "../measure/measureText";
import { cornersText, labelText, readCorners, readSpeed } from "../zones/zoneText";
import { language } from "./language";
import { feetAndInches, fieldText, shown, typed, units } from "./units";

afterEach(() => {
  units.choose("metric");
  language.choose("en");
});

/** Figures of every size that a map has, the same in each run. */
function* figures(count: number): Generator<number> {
  let seed = 20261125;
  for (let n = 0; n < count; n++) {
    seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
    const size = 10 ** ((seed % 8) - 3);
    seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
    yield ((seed / 2 ** 32) * 2 - 1) * size;
  }
}

describe.each(["metric", "imperial"] as const)("in %s units", (system) => {
  test("what is typed is what was shown in the field, to the last digit", () => {
    units.choose(system);
    for (const figure of figures(2000)) {
      const metric = Number(figure.toFixed(6)) + 0;
      expect(typed(Number(fieldText(metric)))).toBe(metric);
    }
  });

  test("what is shown is what was typed", () => {
    units.choose(system);
    for (const figure of figures(2000)) {
      const feet = Number(figure.toFixed(4));
      expect(shown(typed(feet))).toBeCloseTo(feet, 9);
    }
  });

  test("corners read back as they were", () => {
    units.choose(system);
    const corners = [...figures(300)].map((x) => [Number(x.toFixed(3)) + 0, 1.25] as const);
    expect(readCorners(cornersText(corners))).toEqual({ corners, problem: null });
  });
});

test("a foot is 0.3048 m, exactly", () => {
  units.choose("imperial");
  expect(typed(10)).toBe(3.048);
  expect(typed(1.5)).toBe(0.4572);
  expect(readSpeed("1,5")).toBe(0.4572);
  expect(parseCoordinates("10", "-1.5", "90").goal).toEqual({
    x: 3.048,
    y: -0.4572,
    yaw: Math.PI / 2,
  });
  expect(parseCoordinates("", "1", "").errors.x).toBe("Needed: a number of feet");
});

test("in imperial units lengths are told in feet and inches", () => {
  units.choose("imperial");
  expect([0.041, 0.9, 1.0, 4.23, 120.4].map(distanceText)).toEqual([
    "2 in",
    "35 in",
    "3.3 ft",
    "14 ft",
    "395 ft",
  ]);
  expect([0, 0.1, 0.3048, 3.418, 3.6475].map(lengthText)).toEqual([
    "0 in",
    "4 in",
    "1 ft 0 in",
    "11 ft 3 in",
    "12 ft 0 in",
  ]);
  expect(feetAndInches(1.9)).toEqual({ feet: 6, inches: 3 });
  expect(speedText(0.3048)).toBe("1 ft/s");
  expect(pointText(3.048, -0.3048)).toBe("x 10.00, y −1.00 ft");
  expect(labelText({ name: "Aisle", kind: "speed", speed: 0.3048 })).toBe("Aisle: 1 ft/s");
});

test("in German a number has a decimal comma", () => {
  language.choose("de");
  expect([fixed(1.25, 2), signed(-0.5, 1), distanceText(4.23), speedText(0.3)]).toEqual([
    "1,25",
    "−0,5",
    "4,2 m",
    "0,3 m/s",
  ]);
});
