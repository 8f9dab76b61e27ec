import { Button, TextInput } from "@mantine/core";
import { type FormEvent, useState } from "react";
import { t } from "../texts/text";
import { lengthUnit } from "../texts/units";
import { parseCoordinates } from "./coordinates";
import classes from "./Goal.module.css";
import type { GoalTool } from "./useGoalTool";

interface Props {
  label: string;
  tool: Pick<GoalTool, "check" | "type">;
  view: string;
}

/** A goal or place without a pointer: x and y in the map frame, and a heading if wanted. */
export function CoordinatesForm({ label, tool, view }: Props) {
  const [x, setX] = useState("");
  const [y, setY] = useState("");
  const [heading, setHeading] = useState("");
  const [asked, setAsked] = useState(false);
  const { goal, errors } = parseCoordinates(x, y, heading);

  const submit = (event: FormEvent) => {
    event.preventDefault();
    setAsked(true);
    if (goal !== null) tool.check({ ...goal, view }, null);
  };
  const field = (
    label: string,
    name: "x" | "y" | "heading",
    value: string,
    set: (v: string) => void,
  ) => (
    <TextInput
      label={label}
      inputMode="decimal"
      size="sm"
      value={value}
      autoFocus={name === "x"}
      data-testid={`coordinate-${name}`}
      error={asked ? errors[name] : undefined}
      onChange={(event) => set(event.currentTarget.value)}
      onKeyDown={(event) => {
        if (event.key === "Escape") tool.type(false);
      }}
    />
  );
  return (
    <form className={classes.form} onSubmit={submit} aria-label={label} noValidate>
      <div className={classes.fields}>
        {field(`x (${lengthUnit()})`, "x", x, setX)}
        {field(`y (${lengthUnit()})`, "y", y, setY)}
        {field(t("Heading (°)"), "heading", heading, setHeading)}
      </div>
      <Button type="submit" size="sm" data-testid="coordinate-check">
        {t("Check")}
      </Button>
    </form>
  );
}
