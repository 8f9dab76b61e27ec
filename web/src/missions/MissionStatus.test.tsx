import { cleanup, fireEvent, screen, waitFor } from "@testing-library/react";
import { afterEach, expect, test, vi } from "vitest";
import { ApiError } from "../api/errors";
import type { MissionRun, State } from "../api/types";
import { renderPlain } from "../ui/testing";
import { MissionStatus } from "./MissionStatus";

const { robot, stop, steer } = vi.hoisted(() => ({
  robot: { state: null as State | null, elapsed: 0, frozen: false },
  stop: { drive: { stopped: true, driven_by: "" } },
  steer: vi.fn(),
}));
vi.mock("../state/RobotContext", () => ({ useRobot: () => robot }));
vi.mock("../stop/StopContext", () => ({ useStop: () => stop }));
vi.mock("../session/SessionContext", () => ({
  useSession: () => ({ session: { role: "operator" } }),
}));
vi.mock("../api/missionsClient", () => ({ steerMission: steer }));

afterEach(() => {
  cleanup();
  vi.unstubAllGlobals();
});

const run = {
  number: 1,
  name: "Round",
  by: "ava",
  phase: "paused",
  place: "Dock",
  reason: "ava pressed STOP",
  decided_by: "",
  ask: "",
  skipped: [] as string[],
} as MissionRun;

test("what kept a mission from going on is shown as long as it does, and no longer", async () => {
  robot.state = { missions: { run }, goal: null } as unknown as State;
  steer.mockRejectedValue(new ApiError(409, "The robot is stopped.", "Release STOP."));
  const page = renderPlain(<MissionStatus />);
  fireEvent.click(screen.getByTestId("mission-resume"));
  await waitFor(() => screen.getByTestId("mission-problem"));
  page.rerender(<MissionStatus />);
  screen.getByTestId("mission-problem");
  stop.drive = { stopped: false, driven_by: "" };
  page.rerender(<MissionStatus />);
  await waitFor(() => expect(screen.queryByTestId("mission-problem")).toBeNull());
});
