import type { Action } from "../../../api/ruleTypes";
import { Choice } from "../../../ui/controls/Choice";
import { Picker } from "../../../ui/controls/Picker";
import { type ActionChoice, actionText, choiceKey, grouped } from "../../model/actions";
import classes from "../form/Editor.module.css";

interface Props {
  label: string;
  choices: ActionChoice[];
  action: Action | null;
  onChoose: (choice: ActionChoice) => void;
  testId?: string;
}

/** Chooses what is done, from what there is on this robot. */
export function ActionPicker({ label, choices, action, onChoose, testId }: Props) {
  const key = action === null ? null : choiceKey(action);
  const known = key === null || choices.some((choice) => choice.key === key);
  const groups = grouped(choices);
  const data =
    known || action === null
      ? groups
      : [...groups, { group: "As it is", items: [{ value: key, label: actionText(action) }] }];
  const choose = (chosen: string) => {
    const choice = choices.find((each) => each.key === chosen);
    if (choice !== undefined && chosen !== key) onChoose(choice);
  };
  const shared = {
    className: classes.spring,
    "aria-label": label,
    placeholder: label,
    data,
    maxDropdownHeight: 340,
    nothingFoundMessage: "Nothing like that on this robot",
    "data-testid": testId,
  };
  return key === null ? (
    <Picker {...shared} onPick={choose} />
  ) : (
    <Choice {...shared} searchable value={key} onChange={choose} />
  );
}
