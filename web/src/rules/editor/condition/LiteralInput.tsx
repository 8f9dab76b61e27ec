import { MultiSelect, TagsInput, TextInput } from "@mantine/core";
import type { Literal, Operator } from "../../../api/ruleTypes";
import { units } from "../../../texts/units";
import { Choice } from "../../../ui/controls/Choice";
import { NumberField } from "../../../ui/controls/NumberField";
import { type FieldChoice, fitLiteral, takesList, type ValueKind } from "../../model/signals";
import { constantText } from "../../model/words";

interface Props {
  operator: Operator;
  field: FieldChoice | null;
  value: Literal;
  onChange: (value: Literal) => void;
}

/** What a value is compared with, in an input that fits its kind and knows its constants. */
export function LiteralInput({ operator, field, value, onChange }: Props) {
  const kind = scalarKind(field, value);
  const constants = Object.entries(field?.constants ?? {});
  if (operator === "between") {
    const [low, high] = Array.isArray(value) ? value.map(Number) : [0, 0];
    return (
      <>
        <NumberField
          label="from"
          value={low ?? 0}
          testId="literal"
          onChange={(next) => onChange([next, high ?? next])}
        />
        <NumberField
          label="to"
          value={high ?? 0}
          onChange={(next) => onChange([low ?? next, next])}
        />
      </>
    );
  }
  const many = takesList(operator) || (field?.kind === "list" && Array.isArray(value));
  if (many) {
    const items = (Array.isArray(value) ? value : [value]).map(String);
    const put = (texts: string[]) => onChange(fitLiteral(operator, kind, texts));
    return constants.length > 0 ? (
      <MultiSelect
        size="sm"
        label="these"
        data={constants.map(([name, number]) => ({
          value: String(number),
          label: named(field, name, number),
        }))}
        value={items}
        onChange={put}
        data-testid="literal"
      />
    ) : (
      <TagsInput
        size="sm"
        label="these (Enter after each)"
        value={items}
        onChange={put}
        data-testid="literal"
      />
    );
  }
  const scalar = Array.isArray(value) ? value[0] : value;
  if (kind === "bool") {
    return (
      <Choice
        label="compared with"
        data={["true", "false"]}
        value={String(scalar === true)}
        onChange={(chosen) => onChange(chosen === "true")}
        data-testid="literal"
      />
    );
  }
  if (kind === "int" || kind === "float") {
    const number = typeof scalar === "number" ? scalar : 0;
    const equality = operator === "==" || operator === "!=";
    if (constants.length > 0 && equality) {
      const known = constants.some(([, each]) => each === number);
      return (
        <Choice
          label="compared with"
          searchable
          data={[
            ...constants.map(([name, each]) => ({
              value: String(each),
              label: named(field, name, each),
            })),
            ...(known ? [] : [{ value: String(number), label: String(number) }]),
          ]}
          value={String(number)}
          onChange={(chosen) => onChange(Number(chosen))}
          data-testid="literal"
        />
      );
    }
    return (
      <NumberField
        label={comparedWith()}
        value={number}
        allowDecimal={kind === "float"}
        onChange={onChange}
        testId="literal"
      />
    );
  }
  return (
    <TextInput
      size="sm"
      label="text"
      value={String(scalar ?? "")}
      onChange={(event) => onChange(event.currentTarget.value)}
      data-testid="literal"
    />
  );
}

/** What is compared has the units of its message, whatever the page shows lengths in. */
const comparedWith = (): string =>
  units.get() === "metric" ? "compared with" : "compared with (metric)";

const named = (field: FieldChoice | null, name: string, number: number) =>
  `${constantText(name, String(field?.path.at(-1) ?? ""))} (${number})`;

function scalarKind(field: FieldChoice | null, value: Literal): ValueKind | null {
  if (field !== null) {
    return field.kind === "list" ? (field.element as ValueKind) : field.kind;
  }
  const scalar = Array.isArray(value) ? value[0] : value;
  if (typeof scalar === "boolean") return "bool";
  return typeof scalar === "number" ? "float" : "text";
}
