import { TextInput } from "@mantine/core";
import { IconTrash } from "@tabler/icons-react";
import { useEffect, useMemo } from "react";
import type { Action } from "../api/ruleTypes";
import type { MissionTask } from "../api/types";
import { useRules } from "../rules/context/RulesContext";
import { ActionEditor } from "../rules/editor/action/ActionEditor";
import { ActionPicker } from "../rules/editor/action/ActionPicker";
import { type Editor, EditorProvider } from "../rules/editor/form/EditorContext";
import { type ActionChoice, actionChoices, grouped } from "../rules/model/actions";
import { useSession } from "../session/SessionContext";
import { english } from "../texts/language";
import { type Phrase, t } from "../texts/text";
import { DurationField } from "../ui/controls/DurationField";
import { IconButton } from "../ui/controls/IconButton";
import { Picker } from "../ui/controls/Picker";
import classes from "./Missions.module.css";
import { taskGap } from "./missionText";

interface Props {
  tasks: MissionTask[];
  /** Which place it is, for who cannot see it. */
  where: string;
  /** Somebody has tried to save it: what is missing is said where it is. */
  asked: boolean;
  onChange: (tasks: MissionTask[]) => void;
}

const OWN: { value: string; label: Phrase; task: MissionTask }[] = [
  { value: "wait", label: "Wait", task: { kind: "wait", seconds: 30 } },
  { value: "ask", label: "Wait for a person", task: { kind: "ask", text: "" } },
  { value: "stop", label: "Press STOP", task: { kind: "stop" } },
];

/** What is done at a place, one after the other. */
export function TaskList({ tasks, where, asked, onChange }: Props) {
  const { graph, reloadGraph } = useRules();
  const { session } = useSession();
  useEffect(reloadGraph, [reloadGraph]);
  const who = session.role === "engineer" ? "engineer" : "edited";
  const choices = useMemo(() => actionChoices(graph, who), [graph, who]);
  const editor = useMemo<Editor>(() => ({ graph, findings: [] }), [graph]);
  const add = (key: string) => {
    const action = choices.find((choice) => choice.key === key)?.make();
    const own = OWN.find(({ value }) => value === key)?.task;
    if (action !== undefined) onChange([...tasks, { kind: "act", action }]);
    else if (own !== undefined) onChange([...tasks, own]);
  };
  const put = (index: number, task: MissionTask) =>
    onChange(tasks.map((each, at) => (at === index ? task : each)));
  return (
    <ol className={classes.tasks} aria-label={t("What is done at {where}", { where })}>
      {tasks.map((task, index) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: a task is known by its place in the list
        <li key={index} className={classes.task}>
          <EditorProvider value={editor}>
            <TaskFields
              task={task}
              label={t("Task {index} at {where}", { index: index + 1, where })}
              choices={choices}
              onChange={(next) => put(index, next)}
            />
          </EditorProvider>
          {asked && <Gap task={task} />}
          <IconButton
            label={t("Remove task {index} at {where}", { index: index + 1, where })}
            onClick={() => onChange(tasks.filter((_, at) => at !== index))}
            Icon={IconTrash}
          />
        </li>
      ))}
      <li>
        <Picker
          aria-label={t("Add what is done at {where}", { where })}
          placeholder={tasks.length === 0 ? t("Do nothing there") : t("And then …")}
          data={[
            {
              group: t("At this place"),
              items: OWN.map(({ value, label }) => ({ value, label: t(label) })),
            },
            ...grouped(choices),
          ]}
          maxDropdownHeight={340}
          nothingFoundMessage={t("Nothing like that on this robot")}
          onPick={add}
          data-testid="add-task"
        />
      </li>
    </ol>
  );
}

function Gap({ task }: { task: MissionTask }) {
  const gap = taskGap(task);
  return gap === null ? null : (
    <p className={classes.gap} data-testid="task-gap">
      {gap}
    </p>
  );
}

interface FieldsProps {
  task: MissionTask;
  label: string;
  choices: ActionChoice[];
  onChange: (task: MissionTask) => void;
}

function TaskFields({ task, label, choices, onChange }: FieldsProps) {
  switch (task.kind) {
    case "wait":
      return (
        <DurationField
          label={t("Wait")}
          aria-label={t("{label}: wait", { label })}
          min={0.1}
          max={86_400}
          value={task.seconds}
          onChange={(seconds) => onChange({ ...task, seconds })}
        />
      );
    case "ask":
      return (
        <TextInput
          size="sm"
          label={t("Wait for a person")}
          placeholder={t("What they are to do")}
          value={task.text ?? ""}
          onChange={(event) => onChange({ ...task, text: event.currentTarget.value })}
        />
      );
    case "stop":
      return <span>{t("Press STOP; a person releases it and resumes the mission")}</span>;
    case "act": {
      // There is no message to take a value from: a rule's references have no place here.
      const action = task.action as Action;
      const put = (next: Action) => onChange({ kind: "act", action: next });
      return (
        <div className={classes.form} lang={english()}>
          <ActionPicker
            label={label}
            choices={choices}
            action={action}
            onChoose={(choice) => put(choice.make())}
          />
          <ActionEditor action={action} references={[]} onChange={put} />
        </div>
      );
    }
  }
}
