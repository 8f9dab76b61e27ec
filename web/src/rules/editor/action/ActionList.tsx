import { IconArrowDown, IconArrowUp, IconTrash } from "@tabler/icons-react";
import { useMemo } from "react";
import type { Action, Condition } from "../../../api/ruleTypes";
import { useSession } from "../../../session/SessionContext";
import { IconButton } from "../../../ui/controls/IconButton";
import { findingsAt } from "../../changes/findings";
import { actionChoices } from "../../model/actions";
import { references } from "../../model/arguments";
import { FindingList } from "../../parts/FindingList";
import classes from "../form/Editor.module.css";
import { useEditor } from "../form/EditorContext";
import { ActionEditor } from "./ActionEditor";
import { ActionPicker } from "./ActionPicker";

interface Props {
  actions: Action[];
  condition: Condition;
  onChange: (actions: Action[]) => void;
}

/** What a rule does, one after the other. */
export function ActionList({ actions, condition, onChange }: Props) {
  const { graph, findings } = useEditor();
  const { session } = useSession();
  const who = session.role === "engineer" ? "engineer" : "edited";
  const choices = useMemo(() => actionChoices(graph, who), [graph, who]);
  const available = useMemo(() => references(graph, condition), [graph, condition]);
  const put = (index: number, action: Action) =>
    onChange(actions.map((each, at) => (at === index ? action : each)));
  const move = (index: number, by: number) => {
    const next = [...actions];
    const [taken] = next.splice(index, 1);
    if (taken !== undefined) next.splice(index + by, 0, taken);
    onChange(next);
  };
  return (
    <>
      <FindingList findings={findings.filter((finding) => finding.field === "actions")} />
      <ol className={classes.actions}>
        {actions.map((action, index) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: an action is known by its place
          <li key={index} className={classes.action} data-testid={`actions[${index}]`}>
            <div className={classes.leafHead}>
              <ActionPicker
                label={`Action ${index + 1}`}
                choices={choices}
                action={action}
                onChoose={(choice) => put(index, choice.make())}
              />
              <IconButton
                label={`Action ${index + 1} earlier`}
                disabled={index === 0}
                onClick={() => move(index, -1)}
                Icon={IconArrowUp}
              />
              <IconButton
                label={`Action ${index + 1} later`}
                disabled={index === actions.length - 1}
                onClick={() => move(index, 1)}
                Icon={IconArrowDown}
              />
              <IconButton
                label={`Remove action ${index + 1}`}
                onClick={() => onChange(actions.filter((_, at) => at !== index))}
                Icon={IconTrash}
              />
            </div>
            <ActionEditor
              action={action}
              references={available}
              onChange={(next) => put(index, next)}
            />
            <FindingList findings={findingsAt(findings, `actions[${index}]`)} />
          </li>
        ))}
      </ol>
      <ActionPicker
        label={actions.length === 0 ? "Choose what it does" : "And then …"}
        choices={choices}
        action={null}
        onChoose={(choice) => onChange([...actions, choice.make()])}
        testId="add-action"
      />
    </>
  );
}
