import { cleanup, fireEvent, screen, waitFor } from "@testing-library/react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { ApiError } from "../api/errors";
import type { Mission, Place, PlaceList } from "../api/types";
import { MissionsTo } from "../missions/MissionsTo";
import { renderPlain } from "../ui/testing";
import { PlacesPanel } from "./PlacesPanel";

const { editPlace, deletePlace, restorePlace, asked } = vi.hoisted(() => ({
  editPlace: vi.fn(),
  deletePlace: vi.fn(),
  restorePlace: vi.fn(),
  asked: { list: null as PlaceList | null, missions: [] as Mission[], role: "operator" },
}));
vi.mock("../api/placesClient", () => ({ editPlace, deletePlace, restorePlace }));
vi.mock("./usePlaces", () => ({ usePlaces: () => ({ list: asked.list, error: null }) }));
vi.mock("../missions/useMissions", () => ({
  useMissions: () => ({ list: { missions: asked.missions }, error: null }),
}));
vi.mock("../state/RobotContext", () => ({ useRobot: () => ({ frozen: false }) }));
vi.mock("../session/SessionContext", () => ({
  useSession: () => ({ session: { user: "ava", role: asked.role } }),
}));

const HERE = { id: "0".repeat(32), label: "4.0 × 3.0 m" };
const THERE = { id: "1".repeat(32), label: "9.0 × 7.0 m" };
const place = (id: number, name: string, here = true): Place => ({
  id,
  version: 1,
  name,
  note: "",
  pose: { x: 1, y: 2, yaw: null },
  map: here ? HERE : THERE,
  here,
  home: false,
  author: "ben",
  time: 0,
});

beforeEach(() => {
  asked.missions = [];
  asked.role = "operator";
  asked.list = {
    available: true,
    revision: 1,
    problem: "",
    map: HERE,
    most: 300,
    places: [place(1, "Dock"), place(2, "Attic", false)],
  };
  for (const each of [editPlace, deletePlace, restorePlace]) each.mockReset();
});
afterEach(() => {
  cleanup();
  vi.unstubAllGlobals();
});

const panel = (onGo: ((place: Place) => void) | null, count = 0) => (
  <PlacesPanel onGo={onGo} asked={count} deleted={MissionsTo} />
);
const go = (name: string) => screen.queryByRole("button", { name: `Go to ${name}` });

async function choose(name: string, item: RegExp) {
  fireEvent.click(screen.getByRole("button", { name: `More for ${name}` }));
  fireEvent.click(await screen.findByRole("menuitem", { name: item }));
}

test("a place of another map waits apart, is not gone to, and can be taken along", async () => {
  const onGo = vi.fn();
  editPlace.mockResolvedValue(place(2, "Attic"));
  renderPlain(panel(onGo));
  expect(screen.queryByText("Attic")).toBeNull();
  fireEvent.click(screen.getByRole("button", { name: "1 place of other maps" }));
  expect(screen.getByText(/Of a map of 9.0 × 7.0 m/)).toBeTruthy();
  expect(go("Attic")).toBeNull();
  await choose("Attic", /Take along/);
  await waitFor(() =>
    expect(editPlace).toHaveBeenCalledWith(place(2, "Attic", false), { here: true }),
  );
  fireEvent.click(go("Dock") as HTMLElement);
  expect(onGo).toHaveBeenCalledWith(place(1, "Dock"));
});

test("a viewer sees the places, and nothing to press", () => {
  asked.role = "viewer";
  renderPlain(panel(vi.fn()));
  expect(screen.getByText("Dock")).toBeTruthy();
  expect(go("Dock")).toBeNull();
  expect(screen.queryByRole("button", { name: /More for|Save where/ })).toBeNull();
});

test("where a drill is played in the robot's place nobody is sent anywhere", () => {
  renderPlain(panel(null));
  expect(go("Dock")).toBeNull();
  expect(screen.getByRole("button", { name: "Save where the robot stands" })).toBeTruthy();
});

test("undo brings back what was deleted; why it cannot is told beside it", async () => {
  deletePlace.mockResolvedValue(place(1, "Dock"));
  restorePlace.mockRejectedValueOnce(new ApiError(409, "The name is taken.", "Choose another."));
  restorePlace.mockResolvedValueOnce(place(1, "Dock"));
  renderPlain(panel(vi.fn()));
  await choose("Dock", /Delete/);
  fireEvent.click(await screen.findByRole("button", { name: "Undo" }));
  expect((await screen.findByRole("alert")).textContent).toBe("The name is taken. Choose another.");
  fireEvent.click(screen.getByRole("button", { name: "Undo" }));
  await waitFor(() => expect(screen.queryByRole("button", { name: "Undo" })).toBeNull());
  expect(restorePlace.mock.calls.map(([of]) => of.name)).toEqual(["Dock", "Dock"]);
});

const mission = (name: string, ...places: number[]): Mission => ({
  id: 1,
  version: 1,
  name,
  waypoints: places.map((to) => ({ place: to, tasks: [] })),
  attempts: 1,
  on_failure: "pause",
  rounds: 1,
  schedule: null,
  map: HERE,
  here: true,
  author: "ben",
  role: "operator",
  time: 0,
});

test("who deletes a place is told which missions go there", async () => {
  deletePlace.mockResolvedValue(place(1, "Dock"));
  asked.missions = [mission("Night", 2, 1), mission("Day", 2), mission("Noon", 1)];
  renderPlain(panel(vi.fn()));
  await choose("Dock", /Delete/);
  expect((await screen.findByRole("status")).textContent).toContain(
    "Deleted Dock. Missions that go there: Night, Noon.",
  );
});

test("a place is moved to where the robot stands, and back again", async () => {
  const moved = { ...place(1, "Dock"), version: 2, pose: { x: 3, y: 4, yaw: 0 } };
  editPlace.mockResolvedValueOnce(moved);
  editPlace.mockResolvedValueOnce({ ...place(1, "Dock"), version: 3 });
  renderPlain(panel(vi.fn()));
  await choose("Dock", /Move to where the robot stands/);
  fireEvent.click(await screen.findByRole("button", { name: "Undo" }));
  await waitFor(() => expect(screen.queryByRole("button", { name: "Undo" })).toBeNull());
  expect(editPlace.mock.calls).toEqual([
    [place(1, "Dock"), { to_robot: true }],
    [moved, { pose: place(1, "Dock").pose }],
  ]);
});

test("a robot that keeps no places says why, and offers to save none", () => {
  asked.list = {
    ...(asked.list as PlaceList),
    available: false,
    problem: "places cannot be kept: the disk is full",
    places: [],
  };
  renderPlain(panel(vi.fn()));
  expect(screen.getByText(/the disk is full/)).toBeTruthy();
  expect(screen.queryByRole("button", { name: /Save where/ })).toBeNull();
});

test("whoever asks for the places by key is brought to the first", () => {
  const { rerender } = renderPlain(panel(vi.fn()));
  expect(document.activeElement).toBe(document.body);
  rerender(panel(vi.fn(), 1));
  expect(document.activeElement).toBe(go("Dock"));
});
