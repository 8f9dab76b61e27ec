import { cleanup, fireEvent, screen } from "@testing-library/react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { Table, TableView } from "../../api/ruleTypes";
import { renderPlain } from "../../ui/testing";
import type { Draft } from "../changes/draft";
import { DraftBar } from "../DraftBar";
import { ConflictPage } from "./ConflictPage";

const { rules, go, place } = vi.hoisted(() => ({
  rules: { view: null as TableView | null, draft: {} as object },
  go: vi.fn(),
  place: { at: "conflict" },
}));
vi.mock("../context/RulesNav", () => ({ useNav: () => ({ go, place }) }));
vi.mock("../context/RulesContext", () => ({
  useRules: () => ({ ...rules, mayEdit: true, check: { findings: [] } }),
}));

const discardAll = vi.fn();
const table = { rules: [] } as unknown as Table;
const mine = { robot: "r", base: 3, baseTable: table, table, reason: "" } as Draft;
const handle = { draft: mine, changes: [{}], overtaken: true, undo: null, discardAll };

beforeEach(() => {
  vi.clearAllMocks();
  place.at = "conflict";
  rules.view = { robot: "r", revision: 4, table } as TableView;
  rules.draft = handle;
});
afterEach(() => {
  cleanup();
  vi.unstubAllGlobals();
});

test("a merge without differences says so, and leads on to the rules", () => {
  renderPlain(<ConflictPage />);
  expect(screen.getByTestId("conflict").textContent).toContain("revision 4 says the same");
  fireEvent.click(screen.getByRole("button", { name: "To the rules" }));
  expect(discardAll).toHaveBeenCalled();
  expect(go).toHaveBeenCalledWith({ at: "table" });
});

test("a merge of which nothing is left leads on to the rules", () => {
  rules.draft = { ...handle, draft: null, overtaken: false };
  renderPlain(<ConflictPage />);
  fireEvent.click(screen.getByRole("button", { name: "To the rules" }));
  expect(go).toHaveBeenCalledWith({ at: "table" });
});

test.each(["review", "conflict"])("who discards in the %s is back at the rules", (at) => {
  place.at = at;
  renderPlain(<DraftBar />);
  fireEvent.click(screen.getByRole("button", { name: "Discard" }));
  expect(discardAll).toHaveBeenCalled();
  expect(go).toHaveBeenCalledWith({ at: "table" });
});
