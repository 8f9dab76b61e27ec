import { TextInput } from "@mantine/core";
import { IconTrash } from "@tabler/icons-react";
import { useEffect, useMemo } from "react";
import type { Action } from "../api/ruleTypes";
import type { MissionTask } from "../api/types";
import { useRules } from "../rules/context/RulesContext";
import { ActionEditor } from "../rules/editor/action/ActionEditor";
import { ActionPicker } from "../rules/editor/action/ActionPicker";
import { type Editor, EditorProvider } from "../rules/editor/form/EditorContext";
import { actionChoices } from "../rules/model/actions";
import { useSession } from "../session/SessionContext";
import { DurationField } from "../ui/controls/DurationField";
import { IconButton } from "../ui/controls/IconButton";
import { Picker } from "../ui/controls/Picker";
import classes from "./Missions.module.css";
import { taskLabel } from "./missionText";

interface Props {
  tasks: MissionTask[];
  /** Which place it is, for who cannot see it. */
  where: string;
  onChange: (tasks: MissionTask[]) => void;
}

const KINDS = ["wait", "ask", "act", "stop"] as const;

const begun: Record<(typeof KINDS)[number], MissionTask> = {
  wait: { kind: "wait", seconds: 30 },
  ask: { kind: "ask", text: "" },
  stop: { kind: "stop" },
  act: {
    kind: "act",
    action: { kind: "log", text: "", level: "info", timeout: 10, on_error: "abort" },
  },
};

/** What is done at a place, one after the other. */
export function TaskList({ tasks, where, onChange }: Props) {
  const put = (index: number, task: MissionTask) =>
    onChange(tasks.map((each, at) => (at === index ? task : each)));
  return (
    <ol className={classes.tasks} aria-label={`What is done at ${where}`}>
      {tasks.map((task, index) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: a task is known by its place in the list
        <li key={index} className={classes.task}>
          <TaskFields
            task={task}
            label={`Task ${index + 1} at ${where}`}
            onChange={(next) => put(index, next)}
          />
          <IconButton
            label={`Remove task ${index + 1} at ${where}`}
            onClick={() => onChange(tasks.filter((_, at) => at !== index))}
            Icon={IconTrash}
          />
        </li>
      ))}
      <li>
        <Picker
          aria-label={`Add what is done at ${where}`}
          placeholder={tasks.length === 0 ? "Do nothing there" : "And then …"}
          data={KINDS.map((kind) => ({ value: kind, label: taskLabel(kind) }))}
          searchable={false}
          onPick={(kind) => onChange([...tasks, begun[kind as keyof typeof begun]])}
        />
      </li>
    </ol>
  );
}

interface FieldsProps {
  task: MissionTask;
  label: string;
  onChange: (task: MissionTask) => void;
}

function TaskFields({ task, label, onChange }: FieldsProps) {
  switch (task.kind) {
    case "wait":
      return (
        <DurationField
          label="Wait"
          aria-label={`${label}: wait`}
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
          label="Wait for a person"
          placeholder="What they are to do"
          value={task.text ?? ""}
          onChange={(event) => onChange({ ...task, text: event.currentTarget.value })}
        />
      );
    case "stop":
      return <span>Press STOP; a person releases it and resumes the mission</span>;
    case "act":
      return (
        <ActFields
          action={task.action as Action}
          label={label}
          onChange={(action) => onChange({ kind: "act", action: action as typeof task.action })}
        />
      );
  }
}

interface ActProps {
  action: Action;
  label: string;
  onChange: (action: Action) => void;
}

/** What a rule could do; there is no message to take a value from. */
function ActFields({ action, label, onChange }: ActProps) {
  const { graph, reloadGraph } = useRules();
  const { session } = useSession();
  useEffect(reloadGraph, [reloadGraph]);
  const who = session.role === "engineer" ? "engineer" : "edited";
  const choices = useMemo(() => actionChoices(graph, who), [graph, who]);
  const editor = useMemo<Editor>(() => ({ graph, findings: [] }), [graph]);
  return (
    <EditorProvider value={editor}>
      <div className={classes.form}>
        <ActionPicker
          label={label}
          choices={choices}
          action={action}
          onChoose={(choice) => onChange(choice.make())}
        />
        <ActionEditor action={action} references={[]} onChange={onChange} />
      </div>
    </EditorProvider>
  );
}
