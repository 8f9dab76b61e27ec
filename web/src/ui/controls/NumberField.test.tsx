import { MantineProvider } from "@mantine/core";
import { cleanup, fireEvent, render, screen } from "@testing-library/react";
import { useState } from "react";
import { afterEach, expect, test, vi } from "vitest";
import { NumberField } from "./NumberField";

afterEach(cleanup);

function field(onChange: (value: number) => void) {
  function Held() {
    const [value, setValue] = useState(4);
    return (
      <NumberField
        aria-label="times"
        value={value}
        min={1}
        max={10}
        onChange={(next) => {
          setValue(next);
          onChange(next);
        }}
      />
    );
  }
  render(
    <MantineProvider>
      <Held />
    </MantineProvider>,
  );
  return screen.getByRole("textbox");
}

test("a number beyond the limits is not taken, and the field says so and what holds", () => {
  const changed = vi.fn();
  const input = field(changed);
  fireEvent.change(input, { target: { value: "9999" } });
  fireEvent.blur(input);
  expect(changed).not.toHaveBeenCalled();
  expect(screen.getByText("At most 10. It stays 4.")).toBeTruthy();
  fireEvent.change(input, { target: { value: "0" } });
  expect(screen.getByText("At least 1. It stays 4.")).toBeTruthy();
  fireEvent.change(input, { target: { value: "7" } });
  expect(changed).toHaveBeenCalledExactlyOnceWith(7);
  expect(screen.queryByText(/It stays/)).toBeNull();
});

test("a field that is left empty says again what holds", () => {
  const changed = vi.fn();
  const input = field(changed);
  fireEvent.change(input, { target: { value: "" } });
  fireEvent.blur(input);
  expect((input as HTMLInputElement).value).toBe("4");
  expect(changed).not.toHaveBeenCalled();
});
