import { TextInput } from "@mantine/core";
import type { Action } from "../../../api/ruleTypes";
import { Choice } from "../../../ui/controls/Choice";
import { DurationField } from "../../../ui/controls/DurationField";
import { NumberField } from "../../../ui/controls/NumberField";
import { Toggle } from "../../../ui/controls/Toggle";
import page from "../../../ui/page.module.css";
import {
  type ArgumentField,
  flatten,
  kindOf,
  messageFields,
  type Reference,
} from "../../model/arguments";
import classes from "../form/Editor.module.css";
import { useEditor } from "../form/EditorContext";
import { ArgumentList } from "./ArgumentList";
import { MissionChoice } from "./MissionChoice";

interface Props {
  action: Action;
  references: Reference[];
  onChange: (action: Action) => void;
}

/** What one action needs to know, and what becomes of the rest when it fails. */
export function ActionEditor(props: Props) {
  const { action, onChange } = props;
  return (
    <>
      <Fields {...props} />
      <div className={page.line}>
        <Toggle
          on={action.timeout !== null}
          label="It must end within a time"
          onChange={(on) => onChange({ ...action, timeout: on ? 10 : null })}
        >
          it must end within
        </Toggle>
        {action.timeout !== null && (
          <DurationField
            aria-label="Seconds after which it has failed"
            inline
            min={0.01}
            value={action.timeout}
            onChange={(timeout) => onChange({ ...action, timeout })}
          />
        )}
        <Toggle
          on={action.on_error === "continue"}
          label="Go on with the next if it fails"
          onChange={(on) => onChange({ ...action, on_error: on ? "continue" : "abort" })}
        >
          go on with the next if it fails
        </Toggle>
      </div>
    </>
  );
}

function Fields({ action, references, onChange }: Props) {
  const { graph } = useEditor();
  switch (action.kind) {
    case "log":
      return (
        <div className={classes.grid}>
          <TextInput
            size="sm"
            label="Line"
            className={classes.wide}
            value={action.text}
            data-testid="log-text"
            onChange={(event) => onChange({ ...action, text: event.currentTarget.value })}
          />
          <Choice
            label="as"
            data={["debug", "info", "warning", "error"]}
            value={action.level}
            onChange={(level) => onChange({ ...action, level: level as typeof action.level })}
          />
        </div>
      );
    case "raise_alarm":
    case "clear_alarm":
      return (
        <div className={classes.grid}>
          <TextInput
            size="sm"
            label="Alarm"
            value={action.alarm}
            onChange={(event) => onChange({ ...action, alarm: event.currentTarget.value })}
          />
          <TextInput
            size="sm"
            label="Text for the operators"
            className={classes.wide}
            value={action.text}
            onChange={(event) => onChange({ ...action, text: event.currentTarget.value })}
          />
        </div>
      );
    case "method": {
      const component = graph?.components.find(({ name }) => name === action.component);
      const method = component?.methods.find(({ name }) => name === action.method);
      const fields = (method?.arguments ?? []).map(
        (argument): ArgumentField => ({
          name: argument.name,
          kind: kindOf(argument.kind, argument.value),
          text: argument.text,
          constants: {},
          initial: argument.value,
        }),
      );
      return (
        <>
          {method !== undefined && method.text !== "" && (
            <p className={page.muted}>{method.text.split("\n")[0]}</p>
          )}
          <ArgumentList
            fields={fields}
            values={action.kwargs}
            references={references}
            onChange={(kwargs) => onChange({ ...action, kwargs })}
          />
        </>
      );
    }
    case "update_parameters":
    case "reconfigure": {
      const component = graph?.components.find(({ name }) => name === action.component);
      const fields = (component?.parameters ?? []).map(
        (parameter): ArgumentField => ({
          name: parameter.name,
          kind: kindOf(parameter.kind, parameter.value),
          text: parameter.text,
          constants: {},
          initial: parameter.value,
        }),
      );
      if (action.kind === "update_parameters") {
        return (
          <ArgumentList
            fields={fields}
            values={action.parameters}
            references={references}
            onChange={(parameters) => onChange({ ...action, parameters })}
          />
        );
      }
      return typeof action.config === "string" ? (
        <TextInput
          size="sm"
          label="File on the robot (yaml, toml or json)"
          value={action.config}
          onChange={(event) => onChange({ ...action, config: event.currentTarget.value })}
        />
      ) : (
        <ArgumentList
          fields={fields}
          values={action.config}
          references={references}
          onChange={(config) => onChange({ ...action, config })}
        />
      );
    }
    case "publish":
      return (
        <>
          <ArgumentList
            fields={messageFields(graph, action.type)}
            values={flatten(action.message)}
            references={references}
            onChange={(message) => onChange({ ...action, message })}
          />
          <div className={page.line}>
            <Toggle
              on={action.rate !== null}
              label="Again and again"
              onChange={(on) => onChange({ ...action, rate: on ? 1 : null, period: on ? 5 : null })}
            >
              again and again
            </Toggle>
            {action.rate !== null && (
              <>
                <NumberField
                  aria-label="Messages a second"
                  suffix=" Hz"
                  w={88}
                  min={0.01}
                  value={action.rate}
                  onChange={(rate) => onChange({ ...action, rate })}
                />
                for
                <DurationField
                  aria-label="For how many seconds"
                  inline
                  min={0.01}
                  value={action.period ?? 5}
                  onChange={(period) => onChange({ ...action, period })}
                />
              </>
            )}
          </div>
        </>
      );
    case "call_service":
      return (
        <ArgumentList
          fields={messageFields(graph, `${action.type}_Request`)}
          values={flatten(action.request)}
          references={references}
          onChange={(request) => onChange({ ...action, request })}
        />
      );
    case "send_goal":
      return (
        <ArgumentList
          fields={messageFields(graph, `${action.type}_Goal`)}
          values={flatten(action.goal)}
          references={references}
          onChange={(goal) => onChange({ ...action, goal })}
        />
      );
    case "python":
      return <p className={page.muted}>Code of the recipe: it cannot be edited here.</p>;
    case "start_mission":
      return (
        <MissionChoice
          mission={action.mission}
          onChange={(mission) => onChange({ ...action, mission })}
        />
      );
    case "lifecycle":
    case "cancel_goal":
      return null;
  }
}
