import { cleanup, fireEvent, screen } from "@testing-library/react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { ApiError } from "../api/errors";
import type { Goal, State } from "../api/types";
import { renderPlain } from "../ui/testing";
import { GoalStatus } from "./GoalStatus";

const { robot, sendGoal, who } = vi.hoisted(() => ({
  robot: { state: null as State | null, elapsed: 0, frozen: false, cause: null },
  sendGoal: vi.fn(),
  who: { role: "operator" },
}));
vi.mock("../state/RobotContext", () => ({
  useRobot: () => robot,
  useNow: () => 1_790_000_000,
}));
vi.mock("../stop/StopContext", () => ({ useStop: () => ({ drive: null }) }));
vi.mock("../session/SessionContext", () => ({ useSession: () => ({ session: who }) }));
vi.mock("../api/client", () => ({ sendGoal, cancelGoal: vi.fn() }));

const failed: Goal = {
  id: "a",
  phase: "failed",
  x: 1,
  y: 2,
  yaw: 0.5,
  sent_by: "ava",
  message: "No way around.",
  distance_left: null,
  eta: null,
  error: null,
  elapsed: 12,
  ended: 4,
  hindrance: "",
};
const show = (goal: Goal) => {
  robot.state = { goal, missions: { run: null } } as State;
  return renderPlain(<GoalStatus />);
};

beforeEach(() => {
  sendGoal.mockReset().mockResolvedValue({});
  who.role = "operator";
});
afterEach(() => {
  cleanup();
  vi.unstubAllGlobals();
});

test("how a goal ended is told with when that was", () => {
  show(failed);
  expect(screen.getByTestId("goal-status").textContent).toContain("No way around.");
  expect(screen.getByTestId("goal-status").textContent).toContain("4 s ago");
});

test("what is in the way of a goal under way is told, with its place", () => {
  const hindrance = "In the way: something that the lidar sees at (1.20, 0.45), 0.31 m ahead.";
  show({ ...failed, phase: "driving", ended: null, hindrance });
  expect(screen.getByTestId("goal-status").textContent).toContain(hindrance);
});

test("a goal that failed is sent again with one press, to the same place", () => {
  show(failed);
  fireEvent.click(screen.getByRole("button", { name: "Send again" }));
  expect(sendGoal).toHaveBeenCalledWith({ x: 1, y: 2, yaw: 0.5 });
});

test("why it was not sent again is told where the button is", async () => {
  sendGoal.mockRejectedValue(new ApiError(409, "Occupied.", "Choose another point."));
  show(failed);
  fireEvent.click(screen.getByTestId("goal-again"));
  expect(await screen.findByText(/Choose another point/)).toBeTruthy();
});

test("nothing is offered where there is nothing to send, or nobody who may", () => {
  show({ ...failed, phase: "arrived" });
  expect(screen.queryByTestId("goal-again")).toBeNull();
  cleanup();
  who.role = "viewer";
  show(failed);
  expect(screen.queryByTestId("goal-again")).toBeNull();
});

test("what ended before this page was opened is no news to it; a card that was closed stays so", () => {
  show({ ...failed, ended: 3600 });
  expect(screen.queryByTestId("goal-status")).toBeNull();
  cleanup();
  show(failed);
  fireEvent.click(screen.getByRole("button", { name: "Hide this goal" }));
  expect(screen.queryByTestId("goal-status")).toBeNull();
});
