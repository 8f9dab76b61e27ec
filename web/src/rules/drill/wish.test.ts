import { beforeEach, expect, test } from "vitest";
import { newScenario } from "./scenario";
import { keepWish, keptWish } from "./wish";

beforeEach(() => sessionStorage.clear());

test("what was made up is there when the page is loaded again", () => {
  const wish = { own: true, count: "4", scenario: newScenario("hexagon", "turtlebot3") };
  keepWish(wish);
  expect(keptWish()).toEqual(wish);
});

test("nothing is wished at first, and what another release has kept is no wish", () => {
  const nothing = { own: false, count: "20", scenario: null };
  expect(keptWish()).toEqual(nothing);
  const others = [{ own: true }, { own: true, count: "4", scenario: { goals: 3 } }, 5];
  for (const kept of [...others.map((each) => JSON.stringify(each)), "{half"]) {
    sessionStorage.setItem("kompass.drill", kept);
    expect(keptWish()).toEqual(nothing);
  }
});
