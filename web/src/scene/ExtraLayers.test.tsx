import { Menu } from "@mantine/core";
import { cleanup, fireEvent, screen } from "@testing-library/react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { Extra, View } from "../api/types";
import { robot } from "../state/fixtures";
import { renderPlain } from "../ui/testing";
import { ExtraLayers } from "./ExtraLayers";
import { MOST_EXTRAS } from "./extraText";

const { said } = vi.hoisted(() => ({ said: { extras: [] as Extra[] } }));
vi.mock("../state/RobotContext", () => ({ useRobot: () => ({ state: robot(said) }) }));

const extra = (topic: string, part: Partial<Extra> = {}): Extra => ({
  topic,
  kind: "cloud",
  age: null,
  problem: "",
  note: "",
  ...part,
});
const view = (extras: string[]): View => ({
  id: "a",
  follow: false,
  top: false,
  theme: "light",
  extras,
  layers: {
    map: true,
    local_map: true,
    path: true,
    scan: true,
    robot: true,
    goal: true,
    trail: true,
    places: true,
    zones: true,
  },
});
const toggled = vi.fn();
const show = (extras: string[]) =>
  renderPlain(
    <Menu opened>
      <Menu.Dropdown>
        <ExtraLayers view={view(extras)} onToggle={toggled} />
      </Menu.Dropdown>
    </Menu>,
  );
const textOf = (topic: string) => screen.getByTestId(`extra-${topic}`).textContent;

beforeEach(() => {
  toggled.mockReset();
  said.extras = [extra("/camera/points"), extra("/other/plan", { kind: "path", age: 0.2 })];
});
afterEach(() => {
  cleanup();
  vi.unstubAllGlobals();
});

test("topics are listed with what they are, off, and one is switched by its name", () => {
  show([]);
  expect(screen.getByText("More on this robot")).toBeTruthy();
  expect(textOf("/camera/points")).toBe("/camera/pointsPoint cloud");
  const item = screen.getByTestId("extra-/other/plan");
  expect(item.getAttribute("aria-checked")).toBe("false");
  fireEvent.click(item);
  expect(toggled).toHaveBeenCalledExactlyOnceWith("/other/plan");
});

test("a layer that is on says what is wrong with it, or what of it is left out", () => {
  const problem = "Its frame camera is not connected to map: no transform says where it is.";
  said.extras = [
    extra("/a", { age: 0.1, problem }),
    extra("/b", { age: 0.1, note: "One in 4 of 32000 points is drawn." }),
    extra("/c"),
  ];
  show(["/a", "/b", "/c", "/d"]);
  expect(textOf("/a")).toContain(problem);
  expect(textOf("/b")).toContain("One in 4");
  expect(textOf("/c")).toContain("Nothing has come yet.");
  expect(textOf("/d")).toContain("Nobody publishes it now.");
});

test("with as many as a page may show, no further one can be switched on", () => {
  const many = Array.from({ length: MOST_EXTRAS + 1 }, (_, i) => extra(`/t${i}`, { age: 0.1 }));
  said.extras = many;
  show(many.slice(1).map(({ topic }) => topic));
  expect(textOf("/t0")).toContain("8 of these at most: switch one off first.");
  fireEvent.click(screen.getByTestId("extra-/t0"));
  expect(toggled).not.toHaveBeenCalled();
  fireEvent.click(screen.getByTestId("extra-/t1"));
  expect(toggled).toHaveBeenCalledOnce();
});

test("a robot without further topics has no list of them", () => {
  said.extras = [];
  show([]);
  expect(screen.queryByText("More on this robot")).toBeNull();
});
