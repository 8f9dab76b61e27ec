import { NumberInput, type NumberInputProps } from "@mantine/core";
import { useEffect, useState } from "react";

interface Props extends Omit<NumberInputProps, "value" | "onChange"> {
  value: number;
  onChange: (value: number) => void;
  testId?: string;
}

/** A number that may be half-typed: told only once it is one, and what it was when left empty. */
export function NumberField({ value, onChange, testId, ...rest }: Props) {
  const [shown, setShown] = useState<number | string>(value);
  useEffect(() => setShown((was) => (Number(was) === value && was !== "" ? was : value)), [value]);
  return (
    <NumberInput
      size="sm"
      hideControls
      inputMode="decimal"
      decimalSeparator="."
      allowedDecimalSeparators={[".", ","]}
      {...rest}
      data-testid={testId}
      value={shown}
      onChange={(next) => {
        setShown(next);
        const number = typeof next === "number" ? next : Number.parseFloat(next);
        if (Number.isFinite(number) && number !== value) onChange(number);
      }}
      onBlur={() => setShown(value)}
    />
  );
}
