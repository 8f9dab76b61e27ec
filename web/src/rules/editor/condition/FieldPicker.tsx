import { useMemo } from "react";
import type { Signal } from "../../../api/ruleTypes";
import { Choice } from "../../../ui/controls/Choice";
import { signalText } from "../../model/condition";
import { type FieldChoice, fieldChoices, fieldKey } from "../../model/signals";
import { useEditor } from "../form/EditorContext";

interface Props {
  signal: Signal;
  onChange: (field: FieldChoice) => void;
}

/** The values inside the messages of a topic, with what can be made of its lists in words. */
export function FieldPicker({ signal, onChange }: Props) {
  const { graph } = useEditor();
  const choices = useMemo(
    () => fieldChoices(graph, signal.type).filter((choice) => choice.kind !== "message"),
    [graph, signal.type],
  );
  const key = signal.path.length === 0 ? null : fieldKey(signal.path, signal.aggregate);
  const known = key === null || choices.some((choice) => choice.key === key);
  const data = choices.map((choice) => ({ value: choice.key, label: choice.label }));
  return (
    <Choice
      label="which value"
      placeholder={signal.topic === "" ? "First choose a topic" : "Choose a value"}
      searchable
      disabled={signal.topic === ""}
      data={known ? data : [...data, { value: key, label: signalText(signal) }]}
      value={key}
      onChange={(chosen) => {
        const field = choices.find((choice) => choice.key === chosen);
        if (field !== undefined) onChange(field);
      }}
      maxDropdownHeight={320}
      nothingFoundMessage="No such value in this message"
      data-testid="field-picker"
    />
  );
}
