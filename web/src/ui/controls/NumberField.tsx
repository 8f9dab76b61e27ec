import { NumberInput, type NumberInputProps } from "@mantine/core";
import { useEffect, useState } from "react";
import { t } from "../../texts/text";

interface Props extends Omit<NumberInputProps, "value" | "onChange" | "min" | "max"> {
  value: number;
  onChange: (value: number) => void;
  min?: number;
  max?: number;
  testId?: string;
}

/**
 * A number that may be half-typed: told only once it is one, and what it was when left empty. What
 * is too small or too large is not taken: the field says so, and what holds instead.
 */
export function NumberField({ value, onChange, min, max, testId, error, ...rest }: Props) {
  const [shown, setShown] = useState<number | string>(value);
  useEffect(() => setShown((was) => (Number(was) === value && was !== "" ? was : value)), [value]);
  const typed = numberOf(shown);
  const limit = Number.isNaN(typed)
    ? undefined
    : min !== undefined && typed < min
      ? t("At least {value}.", { value: String(min) })
      : max !== undefined && typed > max
        ? t("At most {value}.", { value: String(max) })
        : undefined;
  const stays = t("It stays {value}.", { value: String(value) });
  return (
    <NumberInput
      size="sm"
      hideControls
      inputMode="decimal"
      decimalSeparator="."
      allowedDecimalSeparators={[".", ","]}
      clampBehavior="none"
      {...rest}
      error={limit === undefined ? error : `${limit} ${stays}`}
      data-testid={testId}
      value={shown}
      onChange={(next) => {
        setShown(next);
        const number = numberOf(next);
        const fits = number >= (min ?? -Infinity) && number <= (max ?? Infinity);
        if (fits && Number.isFinite(number) && number !== value) onChange(number);
      }}
      onBlur={() => {
        if (limit === undefined) setShown(value);
      }}
    />
  );
}

const numberOf = (shown: number | string) =>
  typeof shown === "number" ? shown : Number.parseFloat(shown);
