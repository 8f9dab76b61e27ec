import { Select, type SelectProps } from "@mantine/core";

interface Props extends Omit<SelectProps, "onChange"> {
  onChange: (value: string) => void;
}

/** One of several: there is always one chosen. */
export function Choice({ onChange, ...rest }: Props) {
  return (
    <Select
      size="sm"
      allowDeselect={false}
      onChange={(value) => {
        if (value !== null) onChange(value);
      }}
      {...rest}
    />
  );
}
