import { expect, test } from "vitest";
import type { TimelineEntry } from "../api/types";
import { lengthText, sourceText } from "./timelineText";

const ENTRY: TimelineEntry = {
  number: 1,
  key: "",
  kind: "fault",
  level: "error",
  time: 100,
  ended: 100,
  lasts: false,
  count: 1,
  last: 100,
  source: "local_mapper",
  title: "Died",
  text: "",
  who: "",
  link: null,
};

test("it says how long something lasted, lasts, or how often it came", () => {
  expect(lengthText(ENTRY, 200)).toBe("");
  expect(lengthText({ ...ENTRY, ended: 103 }, 200)).toBe("3 s");
  expect(lengthText({ ...ENTRY, ended: null, lasts: true }, 230)).toBe("for 2 min 10 s by now");
  expect(lengthText({ ...ENTRY, ended: null }, 230)).toBe("end not seen");
  expect(lengthText({ ...ENTRY, count: 12, last: 130, ended: 130 }, 230)).toBe("12 times in 30 s");
});

test("components are called what the page calls them", () => {
  expect(sourceText(ENTRY, new Map([["local_mapper", "Local map"]]))).toBe("Local map");
  expect(sourceText(ENTRY, new Map())).toBe("Local mapper");
  expect(sourceText({ ...ENTRY, kind: "rule", source: "unblock" }, new Map())).toBe("Rule");
  expect(sourceText({ ...ENTRY, kind: "goal" }, new Map())).toBe("");
});
