import { TextInput } from "@mantine/core";
import { IconX } from "@tabler/icons-react";
import type { DrillFault, ScheduledFault } from "../../api/drillTypes";
import { Choice } from "../../ui/controls/Choice";
import { DurationField } from "../../ui/controls/DurationField";
import { IconButton } from "../../ui/controls/IconButton";
import classes from "./Drill.module.css";
import { faultText } from "./drillText";
import { ofKind } from "./scenario";

const ENDS = [
  { value: "some", label: "for" },
  { value: "never", label: "to the end" },
];

/** What a figure is, as it stands in the names of faults. */
const UNITS: Record<string, string> = {
  METRES: "metres",
  SHARE: "share",
  DELAY: "delay s",
  RATE: "m per m",
};

interface Props {
  number: number;
  fault: ScheduledFault;
  kinds: readonly DrillFault[];
  /** Of the robot, where a process is to be named. */
  components: readonly string[];
  /** Of the world, where one is to be closed. */
  doorways: readonly string[];
  locked: boolean;
  onChange: (fault: ScheduledFault) => void;
  onRemove: () => void;
}

/** One thing that breaks: what, when, and for how long. */
export function FaultRow(props: Props) {
  const { number, fault, kinds, components, doorways, locked, onChange } = props;
  const [kindName = "", parameter = ""] = parted(fault.name);
  const kind = kinds.find(({ name }) => name === kindName);
  const words =
    kind?.parameter === "NAME"
      ? components
      : kind?.parameter === "DOORWAY"
        ? doorways
        : (kind?.choices ?? []);
  const label = (what: string) => `${what} of fault ${number}`;
  const named = (text: string) => onChange({ ...fault, name: `${kindName}:${text}` });
  return (
    <li className={classes.fault} data-testid={`scenario-fault-${number - 1}`}>
      <Choice
        aria-label={label("Kind")}
        className={classes.kind}
        searchable
        data={kinds.map(({ name }) => ({ value: name, label: faultText(name) }))}
        value={kindName}
        disabled={locked}
        data-testid="fault-kind"
        onChange={(name) => {
          const next = kinds.find((each) => each.name === name);
          if (next !== undefined) onChange(ofKind(fault, next, components));
        }}
      />
      {kind !== undefined &&
        kind.parameter !== "" &&
        (words.length > 0 ? (
          <Choice
            aria-label={label(kind.parameter.toLowerCase())}
            className={classes.parameter}
            data={words.includes(parameter) ? [...words] : [...words, parameter]}
            value={parameter}
            disabled={locked}
            data-testid="fault-parameter"
            onChange={named}
          />
        ) : (
          <TextInput
            aria-label={label(kind.parameter.toLowerCase())}
            className={classes.parameter}
            size="sm"
            value={parameter}
            disabled={locked}
            leftSection={<span className={classes.unit}>{UNITS[kind.parameter] ?? ""}</span>}
            leftSectionWidth={58}
            data-testid="fault-parameter"
            onChange={(event) => named(event.currentTarget.value)}
          />
        ))}
      <span>after</span>
      <DurationField
        aria-label={label("Begin")}
        className={classes.time}
        value={fault.at}
        max={3600}
        disabled={locked}
        testId="fault-at"
        onChange={(at) => onChange({ ...fault, at })}
      />
      {kind?.at_once !== true && (
        <Choice
          aria-label={label("End")}
          className={classes.end}
          data={ENDS}
          value={fault.duration === 0 ? "never" : "some"}
          disabled={locked}
          data-testid="fault-ends"
          onChange={(end) => onChange({ ...fault, duration: end === "never" ? 0 : 10 })}
        />
      )}
      {kind?.at_once !== true && fault.duration > 0 && (
        <DurationField
          aria-label={label("Length")}
          className={classes.time}
          value={fault.duration}
          min={0.1}
          max={3600}
          disabled={locked}
          testId="fault-duration"
          onChange={(duration) => onChange({ ...fault, duration })}
        />
      )}
      <IconButton
        label={`Remove fault ${number}`}
        Icon={IconX}
        disabled={locked}
        onClick={props.onRemove}
      />
      {kind !== undefined && <span className={classes.explained}>{kind.text}</span>}
    </li>
  );
}

/** The kind of a fault, and what stands behind its colon. */
function parted(name: string): [string, string] {
  const colon = name.indexOf(":");
  return colon < 0 ? [name, ""] : [name.slice(0, colon), name.slice(colon + 1)];
}
