import { expect, test } from "vitest";
import { masksText } from "./maskText";

test("masks are told each once, with what they ask for", () => {
  const pit = { name: "Pit", kind: "keep_out", speed: null } as const;
  const ramp = { name: "Ramp", kind: "speed", speed: 0.2 } as const;
  expect(masksText([])).toBeNull();
  expect(masksText([pit, pit, ramp])).toBe(
    "Masks of the recipe, which stay: Pit (Keep out), Ramp (At most 0.2 m/s).",
  );
});
