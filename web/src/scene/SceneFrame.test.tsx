import { render, screen } from "@testing-library/react";
import { expect, test, vi } from "vitest";
import { SceneFrame } from "./SceneFrame";

test("without WebGL the scene says so, and what goes on without it", () => {
  vi.spyOn(HTMLCanvasElement.prototype, "getContext").mockReturnValue(null);
  render(<SceneFrame id="one" />);
  expect(screen.getByTestId("no-webgl").textContent).toContain("no WebGL");
  expect(screen.getByTestId("no-webgl").textContent).toContain("STOP work as always");
  expect(screen.queryByTestId("scene-frame")).toBeNull();
});
