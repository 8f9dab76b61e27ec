import { Select, type SelectProps } from "@mantine/core";
import { useState } from "react";

interface Props extends Omit<SelectProps, "value" | "onChange" | "searchValue"> {
  onPick: (value: string) => void;
}

/** A list from which one thing after the other is taken: it is empty again after each. */
export function Picker({ onPick, ...rest }: Props) {
  const [search, setSearch] = useState("");
  return (
    <Select
      size="sm"
      searchable
      {...rest}
      value={null}
      searchValue={search}
      onSearchChange={setSearch}
      onChange={(value) => {
        // What was typed was for this choice; left there, it would hide all others the next time.
        setSearch("");
        if (value !== null) onPick(value);
      }}
    />
  );
}
