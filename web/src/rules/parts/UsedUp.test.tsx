import { cleanup, fireEvent, screen, waitFor } from "@testing-library/react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { Rule, RuleStatus } from "../../api/ruleTypes";
import { renderPlain } from "../../ui/testing";
import { UsedUp } from "./UsedUp";

const { resetRule, may } = vi.hoisted(() => ({ resetRule: vi.fn(), may: { edit: true } }));
vi.mock("../../api/rulesClient", () => ({ resetRule }));
vi.mock("../context/RulesContext", () => ({ useRules: () => ({ mayEdit: may.edit }) }));
vi.mock("../../state/RobotContext", () => ({ useNow: () => 1060 }));

beforeEach(() => {
  may.edit = true;
  resetRule.mockReset();
});
afterEach(() => {
  cleanup();
  vi.unstubAllGlobals();
});

const rule = { id: "mapper-lost", name: "Mapper lost" } as Rule;

function show(state: RuleStatus["state"]) {
  const status = { rule_id: rule.id, state, last_fired: 1000 } as RuleStatus;
  renderPlain(<UsedUp rule={rule} status={status} />);
}

test("a rule that is spent says so, and one press resets it", async () => {
  resetRule.mockResolvedValue({});
  show("used up");
  expect(screen.getByTestId("used-up").textContent).toMatch(/Used up at \d\d:\d\d; will not fire/);
  fireEvent.click(screen.getByRole("button", { name: "Reset Mapper lost: let it fire again" }));
  await waitFor(() => expect(resetRule).toHaveBeenCalledWith("mapper-lost"));
});

test("a reset that is refused says why beside the button", async () => {
  resetRule.mockRejectedValue({ title: "Refused.", remedy: "Only an engineer resets this one." });
  show("used up");
  fireEvent.click(screen.getByTestId("used-up-reset"));
  expect((await screen.findByRole("alert")).textContent).toBe(
    "Refused. Only an engineer resets this one.",
  );
});

test("who may not edit reads it and has no button", () => {
  may.edit = false;
  show("used up");
  expect(screen.getByTestId("used-up")).toBeTruthy();
  expect(screen.queryByTestId("used-up-reset")).toBeNull();
});

test("of a rule that can fire nothing is said", () => {
  show("ready");
  expect(screen.queryByTestId("used-up")).toBeNull();
});
