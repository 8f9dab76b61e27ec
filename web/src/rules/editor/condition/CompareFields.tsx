import type { Compare, Operator } from "../../../api/ruleTypes";
import { Choice } from "../../../ui/controls/Choice";
import { NumberField } from "../../../ui/controls/NumberField";
import { chosenField, fitLiteral, operatorsFor, withField } from "../../model/signals";
import { useEditor } from "../form/EditorContext";
import { FieldPicker } from "./FieldPicker";
import { LiteralInput } from "./LiteralInput";

interface Props {
  leaf: Compare;
  onChange: (leaf: Compare) => void;
}

/** Which value, how it compares, and with what. */
export function CompareFields({ leaf, onChange }: Props) {
  const { graph } = useEditor();
  const field = chosenField(graph, leaf.signal);
  const operators = operatorsFor(field);
  const known = operators.some(({ value }) => value === leaf.operator);
  const equality = leaf.operator === "==" || leaf.operator === "!=";
  const number = field?.kind === "float";
  return (
    <>
      <FieldPicker signal={leaf.signal} onChange={(choice) => onChange(withField(leaf, choice))} />
      <Choice
        label="comparison"
        data={known ? operators : [...operators, { value: leaf.operator, label: leaf.operator }]}
        value={leaf.operator}
        data-testid="operator"
        onChange={(chosen) => {
          const operator = chosen as Operator;
          onChange({
            ...leaf,
            operator,
            value: fitLiteral(operator, field?.kind ?? null, leaf.value),
            tolerance: operator === "==" || operator === "!=" ? leaf.tolerance : 0,
          });
        }}
      />
      <LiteralInput
        operator={leaf.operator}
        field={field}
        value={leaf.value}
        onChange={(value) => onChange({ ...leaf, value })}
      />
      {equality && number && (
        <NumberField
          label="give or take"
          min={0}
          value={leaf.tolerance}
          onChange={(tolerance) => onChange({ ...leaf, tolerance })}
        />
      )}
    </>
  );
}
