import { act, cleanup, fireEvent, screen } from "@testing-library/react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { CameraNews } from "../api/types";
import { robot } from "../state/fixtures";
import { renderPlain } from "../ui/testing";
import { CameraCorner } from "./CameraCorner";
import { useCameraTool } from "./useCameraTool";

const { sockets, said } = vi.hoisted(() => ({
  sockets: [] as { path: string; open: boolean; sent: unknown[]; say: (news: unknown) => void }[],
  said: { cameras: [] as { topic: string; compressed: boolean }[] },
}));
vi.mock("../api/socket", () => ({
  JsonSocket: class {
    private readonly kept;
    constructor(path: string, on: { message: (news: unknown) => void }) {
      this.kept = { path, open: false, sent: [] as unknown[], say: on.message };
      sockets.push(this.kept);
    }
    open() {
      this.kept.open = true;
    }
    close() {
      this.kept.open = false;
    }
    send(message: unknown) {
      this.kept.sent.push(message);
    }
  },
}));
vi.mock("../state/RobotContext", () => ({ useRobot: () => ({ state: robot(said) }) }));

function Corner({ covered = false }: { covered?: boolean }) {
  return <CameraCorner tool={useCameraTool()} covered={covered} />;
}
const open = () => sockets.filter((each) => each.open);
const news = (part: Partial<CameraNews>): CameraNews => ({
  type: "camera",
  number: 1,
  picture: "data:image/jpeg;base64,AAAA",
  width: 640,
  height: 480,
  age: 0.1,
  problem: "",
  ...part,
});
const say = (part: Partial<CameraNews>) => act(() => open()[0]?.say(news(part)));

beforeEach(() => {
  vi.useFakeTimers({ toFake: ["setInterval", "clearInterval", "performance"] });
  sockets.length = 0;
  said.cameras = [
    { topic: "/front/image", compressed: false },
    { topic: "/back/image", compressed: false },
  ];
});
afterEach(() => {
  cleanup();
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

test("nothing is asked of the robot before somebody looks, and nothing after", () => {
  renderPlain(<Corner />);
  expect(sockets).toEqual([]);
  fireEvent.click(screen.getByTestId("camera-open"));
  expect(open().map(({ path }) => path)).toEqual(["/api/camera?topic=%2Ffront%2Fimage&size=small"]);
  fireEvent.click(screen.getByRole("button", { name: "Close the camera" }));
  expect(open()).toEqual([]);
  expect(screen.queryByTestId("camera-picture")).toBeNull();
});

test("a robot without a camera has no button for one", () => {
  said.cameras = [];
  renderPlain(<Corner />);
  expect(screen.queryByTestId("camera-open")).toBeNull();
});

test("each picture is acknowledged and tells its age; one that stays away for how long", () => {
  renderPlain(<Corner />);
  fireEvent.click(screen.getByTestId("camera-open"));
  say({ number: 7 });
  expect(open()[0]?.sent).toEqual([{ seen: 7 }]);
  expect(screen.getByAltText("What /front/image shows")).toBeTruthy();
  act(() => void vi.advanceTimersByTime(1000));
  expect(screen.getByTestId("camera-told").textContent).toBe("1.1 s old");
  act(() => void vi.advanceTimersByTime(4000));
  expect(screen.getByTestId("camera-told").textContent).toBe("▲ No picture for 5 s");
  say({ number: 7, picture: "", age: 6 });
  expect(screen.getByTestId("camera-told").textContent).toBe("▲ No picture for 6 s");
  expect(open()[0]?.sent).toHaveLength(1);
  say({ picture: "", problem: "The picture is not shown: it is 0 × 0 pixels." });
  expect(screen.getByTestId("camera-told").textContent).toContain("is not shown");
});

test("another camera is another picture, and a larger one is asked for larger", () => {
  renderPlain(<Corner />);
  fireEvent.click(screen.getByTestId("camera-open"));
  say({});
  fireEvent.change(screen.getByTestId("camera-choice"), { target: { value: "/back/image" } });
  expect(screen.queryByTestId("camera-picture")).toBeNull();
  say({});
  fireEvent.click(screen.getByRole("button", { name: "Larger picture" }));
  expect(open().map(({ path }) => path)).toEqual(["/api/camera?topic=%2Fback%2Fimage&size=large"]);
  // What was there goes on being shown until the larger one has come.
  expect(screen.getByTestId("camera-picture")).toBeTruthy();
});

test("what nobody can see is not asked for", () => {
  renderPlain(<Corner covered />);
  fireEvent.click(screen.getByTestId("camera-open"));
  expect(open()).toEqual([]);
});

test("a page in the background asks for no pictures, and for them again when it is back", () => {
  renderPlain(<Corner />);
  fireEvent.click(screen.getByTestId("camera-open"));
  const hide = (hidden: boolean) => {
    vi.spyOn(document, "hidden", "get").mockReturnValue(hidden);
    act(() => void document.dispatchEvent(new Event("visibilitychange")));
  };
  hide(true);
  expect(open()).toEqual([]);
  hide(false);
  expect(open()).toHaveLength(1);
});
