import { Select, TextInput } from "@mantine/core";
import { useState } from "react";
import { Choice } from "../../../ui/controls/Choice";
import { NumberField } from "../../../ui/controls/NumberField";
import { Toggle } from "../../../ui/controls/Toggle";
import { type ArgumentField, isReference, type Reference } from "../../model/arguments";
import classes from "../form/Editor.module.css";

interface Props {
  field: ArgumentField;
  value: unknown;
  references: Reference[];
  onChange: (value: unknown) => void;
}

/** One argument: a value of its kind, or a part of the message that made the rule fire. */
export function ArgumentInput({ field, value, references, onChange }: Props) {
  const taken = isReference(value);
  const first = references[0];
  return (
    <div className={classes.argumentInput}>
      {taken ? (
        <Choice
          label={field.name}
          searchable
          data={[
            ...references.map((each) => ({ value: each.value, label: each.label })),
            ...(references.some((each) => each.value === value) ? [] : [{ value, label: value }]),
          ]}
          value={value}
          onChange={onChange}
        />
      ) : (
        <Plain field={field} value={value} onChange={onChange} />
      )}
      {(first !== undefined || taken) && (
        <Toggle
          on={taken}
          label={`Take ${field.name} from the message`}
          onChange={(on) => onChange(on ? first?.value : (field.initial ?? ""))}
        >
          from the message
        </Toggle>
      )}
    </div>
  );
}

function Plain({ field, value, onChange }: Omit<Props, "references">) {
  const constants = Object.entries(field.constants);
  const label = field.name;
  const description = field.text === "" ? undefined : field.text;
  if (constants.length > 0) {
    return (
      <Select
        size="sm"
        label={label}
        data={constants.map(([name, number]) => ({
          value: String(number),
          label: `${name} (${number})`,
        }))}
        value={String(value)}
        onChange={(chosen) => onChange(Number(chosen))}
      />
    );
  }
  switch (field.kind) {
    case "bool":
      return (
        <Choice
          label={label}
          description={description}
          data={["true", "false"]}
          value={String(value === true)}
          onChange={(chosen) => onChange(chosen === "true")}
        />
      );
    case "int":
    case "float":
      return (
        <NumberField
          label={label}
          description={description}
          allowDecimal={field.kind === "float"}
          value={typeof value === "number" ? value : 0}
          onChange={onChange}
        />
      );
    case "text":
      return (
        <TextInput
          size="sm"
          label={label}
          description={description}
          value={typeof value === "string" ? value : String(value ?? "")}
          onChange={(event) => onChange(event.currentTarget.value)}
        />
      );
    case "list":
    case "message":
      return <Structured label={label} value={value} onChange={onChange} />;
  }
}

/** A list or a nested value, written as JSON; told only once it can be read. */
function Structured(props: { label: string; value: unknown; onChange: (value: unknown) => void }) {
  const { label, value, onChange } = props;
  const [text, setText] = useState(() => JSON.stringify(value));
  const [wrong, setWrong] = useState(false);
  return (
    <TextInput
      size="sm"
      label={`${label} (JSON)`}
      value={text}
      error={wrong ? "This is not JSON yet, for example [1, 2] or {}." : undefined}
      onChange={(event) => {
        const next = event.currentTarget.value;
        setText(next);
        try {
          onChange(JSON.parse(next));
          setWrong(false);
        } catch {
          setWrong(true);
        }
      }}
    />
  );
}
