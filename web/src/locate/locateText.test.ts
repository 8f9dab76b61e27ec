import { expect, test } from "vitest";
import type { LocateCheck } from "../api/types";
import { mapFit } from "../state/localisation";
import { agreementText, movedText } from "./locateText";

const here = { x: 1, y: 2, yaw: 3.1, agreement: 0.61 };
const check = (best: LocateCheck["best"]): LocateCheck => ({
  ok: true,
  message: "",
  here,
  best,
  note: "",
});

test("the card says how well scan and map agree, and that they cannot be compared", () => {
  expect(agreementText(here)).toBe("Scan and map agree 61 %");
  expect(agreementText({ ...here, agreement: null })).toBe("Scan and map cannot be compared");
});

test("how far the best place is from the pressed one is told the short way round", () => {
  const best = { x: 1.1, y: 2.1, yaw: -3.1, agreement: 0.97 };
  expect(movedText(check(best))).toBe(
    "The best place is 14 cm and 5° from the one you pressed, where they agree 61 %.",
  );
  expect(movedText(check(null))).toBe("");
});

test("what is old or unknown has no figure, and says why", () => {
  const known = { agreement: 0.974, age: 0.4, lost: false, problem: null };
  expect(mapFit(known, 0)).toMatchObject({ level: "healthy", figure: "97 %" });
  expect(mapFit(known, 5)).toMatchObject({ level: "unknown", figure: "–" });
  expect(mapFit({ ...known, lost: true }, 0)).toMatchObject({ level: "degraded" });
  const none = { agreement: null, age: null, lost: false, problem: "no_map" as const };
  expect(mapFit(none, 0).sentence).toContain("no map");
});
