import { IconTrash } from "@tabler/icons-react";
import { IconButton } from "../../../ui/controls/IconButton";
import { Picker } from "../../../ui/controls/Picker";
import {
  type ArgumentField,
  fittingReferences,
  kindOf,
  type Reference,
  type Values,
} from "../../model/arguments";
import classes from "../form/Editor.module.css";
import { ArgumentInput } from "./ArgumentInput";

interface Props {
  fields: ArgumentField[];
  values: Values;
  references: Reference[];
  onChange: (values: Values) => void;
}

/** Arguments that are given, and those that could be; the others stay as the robot has them. */
export function ArgumentList({ fields, values, references, onChange }: Props) {
  const given = Object.keys(values);
  const free = fields.filter((field) => !given.includes(field.name));
  const known = new Map(fields.map((field) => [field.name, field]));
  const without = (name: string) =>
    Object.fromEntries(Object.entries(values).filter(([each]) => each !== name));
  const add = (name: string) => {
    const field = known.get(name);
    if (field === undefined) return;
    const whole = fittingReferences(references, "message")[0]?.value;
    onChange({
      ...values,
      [field.name]: field.initial ?? (field.kind === "message" ? (whole ?? {}) : ""),
    });
  };
  return (
    <div className={classes.arguments}>
      {given.map((name) => {
        const field = known.get(name) ?? {
          name,
          kind: kindOf("", values[name]),
          text: "",
          constants: {},
          initial: "",
        };
        return (
          <div key={name} className={classes.argument} data-testid={`argument-${name}`}>
            <ArgumentInput
              field={field}
              value={values[name]}
              references={fittingReferences(references, field.kind)}
              onChange={(value) => onChange({ ...values, [name]: value })}
            />
            <IconButton
              label={`Leave ${name} out`}
              title="Leave it out"
              Icon={IconTrash}
              onClick={() => onChange(without(name))}
            />
          </div>
        );
      })}
      {free.length > 0 && (
        <Picker
          aria-label="Set another value"
          placeholder="Set another value …"
          data={free.map((field) => ({ value: field.name, label: field.name }))}
          onPick={add}
          data-testid="add-argument"
        />
      )}
    </div>
  );
}
