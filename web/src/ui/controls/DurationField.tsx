import { TextInput, type TextInputProps } from "@mantine/core";
import { useEffect, useState } from "react";
import { t } from "../../texts/text";
import { durationFieldText, secondsOf } from "./duration";

interface Props extends Omit<TextInputProps, "value" | "onChange"> {
  /** Seconds. */
  value: number;
  onChange: (seconds: number) => void;
  min?: number;
  max?: number;
  /** In a line of words: small, but with room for what is wrong. */
  inline?: boolean;
  testId?: string;
}

/** A duration in any unit. What is none is not taken: the field says so, and what holds instead. */
export function DurationField({ value, onChange, min = 0, max, inline, testId, ...rest }: Props) {
  const [shown, setShown] = useState(() => durationFieldText(value));
  const seconds = secondsOf(shown);
  const fits = seconds !== null && seconds >= min && (max === undefined || seconds <= max);
  const stays = t("It stays {value}.", { value: durationFieldText(value) });
  useEffect(() => {
    setShown((was) => (secondsOf(was) === value ? was : durationFieldText(value)));
  }, [value]);
  return (
    <TextInput
      size="sm"
      inputMode="text"
      autoComplete="off"
      styles={inline ? { root: { maxWidth: 260 }, input: { width: 96 } } : {}}
      {...rest}
      data-testid={testId}
      value={shown}
      error={
        fits
          ? undefined
          : seconds === null
            ? `${t("Write it as 2.5 s, 5 min or 1 h.")} ${stays}`
            : seconds < min
              ? `${t("At least {value}.", { value: durationFieldText(min) })} ${stays}`
              : `${t("At most {value}.", { value: durationFieldText(max ?? seconds) })} ${stays}`
      }
      onChange={(event) => {
        const text = event.currentTarget.value;
        setShown(text);
        const next = secondsOf(text);
        const good = next !== null && next >= min && (max === undefined || next <= max);
        if (good && next !== value) onChange(next);
      }}
      onBlur={() => {
        if (fits) setShown(durationFieldText(value));
      }}
    />
  );
}
