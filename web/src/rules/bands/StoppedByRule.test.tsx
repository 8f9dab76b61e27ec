import { cleanup, fireEvent, screen } from "@testing-library/react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { Drive, State } from "../../api/types";
import { StopBand } from "../../stop/StopBand";
import { IDLE } from "../../stop/stopMachine";
import { renderPlain } from "../../ui/testing";
import { StoppedByRule } from "./StoppedByRule";

const { robot, stop, go, fired } = vi.hoisted(() => ({
  fired: { firings: null as unknown[] | null },
  robot: { state: null as State | null, elapsed: 0 },
  stop: { drive: null as Drive | null },
  go: vi.fn(),
}));
vi.mock("../../state/RobotContext", () => ({ useRobot: () => robot }));
vi.mock("../../stop/StopContext", () => ({
  useStop: () => ({ stop: IDLE, drive: stop.drive, dismiss: () => {} }),
}));
vi.mock("../../session/SessionContext", () => ({
  useSession: () => ({ session: { role: "operator" } }),
}));
vi.mock("../firings/useFirings", () => ({ useFirings: () => fired }));
vi.mock("../context/RulesNav", () => ({ useNav: () => ({ go }) }));
vi.mock("../context/RulesContext", () => ({
  useRules: () => ({ view: { table: { rules: [{ id: "wall", name: "Wall ahead" }] } } }),
}));

const drive: Drive = {
  available: true,
  stopped: true,
  standstill: true,
  stopped_by: "rule Wall ahead",
  reason: "closer than 20 cm",
  limited_by: "stop",
  driven_by: "",
  speed_factor: 0,
  age: 0.1,
};
const missions = { run: null } as State["missions"];
const band = () => renderPlain(<StopBand why={<StoppedByRule />} />);

beforeEach(() => {
  go.mockReset();
  fired.firings = null;
  robot.elapsed = 0;
});
afterEach(() => {
  cleanup();
  vi.unstubAllGlobals();
});

test("a stop of a rule names the rule, and leads to why it fired", () => {
  robot.state = { drive, missions } as State;
  stop.drive = drive;
  band();
  expect(screen.getByTestId("stop-band").textContent).toContain(
    "Stopped by rule Wall ahead: closer than 20 cm",
  );
  fireEvent.click(screen.getByTestId("stop-why"));
  expect(go).toHaveBeenCalledWith({ at: "why", id: "wall", firing: null });
});

test("a rule that is gone by now is told by the firing that stopped the robot", () => {
  const firing = { kind: "firing", name: "Glass ahead", rule_id: "glass" };
  fired.firings = [firing];
  stop.drive = { ...drive, stopped_by: "rule Glass ahead" };
  robot.state = { drive: stop.drive, missions } as State;
  band();
  fireEvent.click(screen.getByTestId("stop-why"));
  expect(go).toHaveBeenCalledWith({ at: "why", id: "glass", firing });
});

test("who has a mission paused by it is told to resume that, not to send another goal", () => {
  const run = { phase: "paused" } as State["missions"]["run"];
  robot.state = { drive, missions: { ...missions, run } } as State;
  stop.drive = drive;
  band();
  expect(screen.getByTestId("stop-band").textContent).toContain("then resume the mission.");
});

test("a stop of a person leads to no rule", () => {
  robot.state = { drive: { ...drive, stopped_by: "ava" }, missions } as State;
  stop.drive = robot.state.drive;
  band();
  expect(screen.queryByTestId("stop-why")).toBeNull();
});

test("a robot that is lost while it was stopped is told as stopped, greyed, with the age of that", () => {
  robot.state = { drive, missions } as State;
  robot.elapsed = 7.2;
  stop.drive = null;
  band();
  expect(screen.queryByTestId("stop-band")).toBeNull();
  const stale = screen.getByTestId("stop-band-stale");
  expect(stale.getAttribute("data-tone")).toBe("stale");
  expect(stale.textContent).toContain("Was stopped by rule Wall ahead");
  expect(stale.textContent).toContain("Last heard 7.3 s ago; it stays so until somebody releases");
  expect(screen.queryByTestId("release-button")).toBeNull();
});
