import { cleanup, fireEvent, screen } from "@testing-library/react";
import { afterEach, expect, test } from "vitest";
import { renderPlain } from "../../ui/testing";
import { InWords } from "./InWords";

afterEach(cleanup);

test("the robot's own form is under the pointer, and one press away", () => {
  renderPlain(
    <InWords plain="Controller finds no solution" expert="controller/status.status == 1" />,
  );
  const plain = screen.getByRole("button", { name: "Controller finds no solution" });
  expect(plain.title).toBe("controller/status.status == 1");
  expect(screen.queryByText("controller/status.status == 1")).toBeNull();
  fireEvent.click(plain);
  expect(screen.getByText("controller/status.status == 1").tagName).toBe("CODE");
});

test("what is the same in both is no button", () => {
  renderPlain(<InWords plain="stop the robot" expert="stop the robot" />);
  expect(screen.queryByRole("button")).toBeNull();
});
