import { expect, test } from "vitest";
import { pictureAge } from "./cameraText";

test("a picture tells its age, and one that does not come any more for how long", () => {
  expect(pictureAge(0.24, 60)).toEqual({ text: "0.2 s old", stale: false });
  expect(pictureAge(4.2, 60)).toEqual({ text: "No picture for 4 s", stale: true });
  expect(pictureAge(95, 200)).toEqual({ text: "No picture for 1 min", stale: true });
});

test("before the first picture the page waits, and says so when that takes long", () => {
  expect(pictureAge(null, 0.5)).toEqual({ text: "Waiting for the first picture…", stale: false });
  expect(pictureAge(null, 7)).toEqual({ text: "No picture for 7 s", stale: true });
});
