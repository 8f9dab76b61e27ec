import { expect, test } from "vitest";
import { detailsText, failed } from "./auditText";

test("what was before and after is told, and what says nothing is left out", () => {
  expect(
    detailsText({
      reason: "",
      cancel_running: false,
      reset: [],
      before: 3,
      after: 4,
      rules: { changed: ["near", "stuck"], added: ["new"] },
      x: 1.23456,
      yaw: null,
    }),
  ).toBe("3 → 4 · rules: changed near, stuck, added new · x: 1.235");
  expect(detailsText({ reason: "wet floor", before: "moving" })).toBe(
    "before: moving · reason: wet floor",
  );
});

test("what was refused stands out", () => {
  expect(failed("refused: You are not logged in to this console.")).toBe(true);
  expect(failed("wrong token")).toBe(true);
  expect(failed("Revision 4 is in force.")).toBe(false);
  expect(failed("ok")).toBe(false);
});
