import { cleanup, screen } from "@testing-library/react";
import { afterEach, expect, test, vi } from "vitest";
import type { LocateCheck } from "../api/types";
import { renderPlain } from "../ui/testing";
import { LocateCard } from "./LocateCard";
import type { LocateDraft, LocateTool } from "./useLocateTool";

const { robot } = vi.hoisted(() => ({ robot: { state: null, elapsed: 0, frozen: false } }));
vi.mock("../state/RobotContext", () => ({ useRobot: () => robot }));

afterEach(() => {
  robot.frozen = false;
  cleanup();
  vi.unstubAllGlobals();
});

function card(agreement: number, note: string) {
  const here = { x: 1, y: 2, yaw: 0, agreement };
  const check: LocateCheck = { ok: true, message: "", here, best: null, note };
  const draft: LocateDraft = { anchor: null, phase: "checked", check, error: null };
  const set = vi.fn();
  renderPlain(<LocateCard tool={{ set, drop: vi.fn() } as unknown as LocateTool} draft={draft} />);
  return { set, button: screen.getByTestId("locate-set") };
}

test("a place where scan and map agree is offered first", () => {
  const { button } = card(0.97, "");
  expect(button.textContent).toBe("Set");
  expect(button.dataset.variant).toBe("filled");
});

test("a place that is doubted takes a press, and is not offered before the others", () => {
  const { button, set } = card(0.16, "That is little.");
  expect(button.textContent).toBe("Set all the same");
  expect(button.dataset.variant).toBe("default");
  button.click();
  expect(set).toHaveBeenCalledTimes(1);
});

test("a place of a robot that is not heard is set no more", () => {
  robot.frozen = true;
  expect(card(0.97, "").button).toHaveProperty("disabled", true);
});
