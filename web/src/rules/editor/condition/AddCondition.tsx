import { useMemo } from "react";
import type { Condition } from "../../../api/ruleTypes";
import { Picker } from "../../../ui/controls/Picker";
import { blank, KIND_WORDS, presets } from "../../model/presets";
import { useEditor } from "../form/EditorContext";

interface Props {
  label: string;
  onAdd: (condition: Condition) => void;
}

type Kind = keyof typeof KIND_WORDS;

/** Conditions to choose from: what is ready-made for this robot, then any sort from the start. */
export function AddCondition({ label, onAdd }: Props) {
  const { graph } = useEditor();
  const ready = useMemo(() => presets(graph), [graph]);
  const groups = [...new Set(ready.map((preset) => preset.group))];
  const kinds = Object.entries(KIND_WORDS) as [Kind, string][];
  const data = [
    ...groups.map((group) => ({
      group,
      items: ready
        .filter((preset) => preset.group === group)
        .map((preset) => ({ value: preset.key, label: preset.label })),
    })),
    {
      group: "Any topic",
      items: [
        ...kinds.map(([kind, words]) => ({ value: `kind:${kind}`, label: `When ${words} …` })),
        { value: "group:any", label: "A group of conditions …" },
      ],
    },
  ];
  const add = (key: string) => {
    const preset = ready.find((each) => each.key === key);
    if (preset !== undefined) onAdd(preset.make());
    else if (key === "group:any") {
      onAdd({ kind: "any", conditions: [blank("compare", graph, null)] });
    } else if (key.startsWith("kind:")) {
      onAdd(blank(key.slice("kind:".length) as Kind, graph, null));
    }
  };
  return (
    <Picker
      aria-label={label}
      placeholder={label}
      data={data}
      onPick={add}
      maxDropdownHeight={320}
      nothingFoundMessage="Nothing like that on this robot"
      data-testid="add-condition"
    />
  );
}
