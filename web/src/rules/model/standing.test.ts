import { expect, test } from "vitest";
import { standing } from "./standing";

const report = { revision: 2, probation: 60 };

test("until the robot has told of it, what was applied counts", () => {
  expect(standing(report, null)).toEqual({ is: "probation", left: 60 });
  const before = { revision: 1, left: 0 };
  expect(standing(report, before)).toEqual({ is: "probation", left: 60 });
  expect(standing({ ...report, probation: 0 }, before)).toEqual({ is: "kept" });
});

test("a table on probation says how long it still has, and one that was kept that it stays", () => {
  expect(standing(report, { revision: 2, left: 41.2 })).toEqual({
    is: "probation",
    left: 42,
  });
  expect(standing(report, { revision: 2, left: 0 })).toEqual({ is: "kept" });
});

test("a table that was taken back is not said to be in force", () => {
  expect(standing(report, { revision: 3, left: 0 })).toEqual({
    is: "replaced",
    by: 3,
  });
});
