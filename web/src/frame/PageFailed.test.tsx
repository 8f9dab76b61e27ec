import { cleanup, fireEvent, screen } from "@testing-library/react";
import { afterEach, expect, test, vi } from "vitest";
import * as client from "../api/client";
import { Parts } from "../ui/Parts";
import { Problem } from "../ui/Problem";
import { renderPlain } from "../ui/testing";
import { WithStopLeft } from "./PageFailed";

afterEach(cleanup);

const Broken = (): never => {
  throw new TypeError("no such thing");
};
const quiet = () => vi.spyOn(console, "error").mockImplementation(() => {});

test("a page that fails says so, and has a STOP that is sent", async () => {
  quiet();
  vi.spyOn(client, "openStop").mockRejectedValue(new Error("away"));
  const stop = vi.spyOn(client, "stopRobot").mockResolvedValue({ accepted: true, message: "" });
  renderPlain(
    <WithStopLeft>
      <Broken />
    </WithStopLeft>,
  );
  expect(screen.getByTestId("page-failed").textContent).toContain("no such thing");
  fireEvent.pointerDown(screen.getByTestId("stop-button"), { button: 0 });
  expect(stop).toHaveBeenCalledTimes(1);
});

test("a part that fails leaves the others, and can be shown again", () => {
  quiet();
  let broken = true;
  const Sometimes = () => {
    if (broken) throw new TypeError("no such thing");
    return <p>whole</p>;
  };
  renderPlain(
    <Parts>
      <Sometimes />
      <p>beside</p>
    </Parts>,
  );
  expect(screen.getByText("beside")).toBeDefined();
  expect(screen.getByTestId("part-failed").textContent).toContain("no such thing");
  broken = false;
  fireEvent.click(screen.getByText("Show it again"));
  expect(screen.getByText("whole")).toBeDefined();
});

test("an error that is none of the console's is told as the page's own", () => {
  renderPlain(<Problem error={new TypeError("split of undefined")} />);
  expect(screen.getByRole("alert").textContent).toContain("split of undefined");
});

test("what failed and is not shown any more has not failed when it is shown anew", () => {
  quiet();
  const { rerender } = renderPlain(
    <Parts>
      <Broken />
    </Parts>,
  );
  expect(screen.getByTestId("part-failed")).toBeDefined();
  rerender(<Parts>{false}</Parts>);
  expect(screen.queryByTestId("part-failed")).toBeNull();
  rerender(
    <Parts>
      <p>whole</p>
    </Parts>,
  );
  expect(screen.getByText("whole")).toBeDefined();
});
