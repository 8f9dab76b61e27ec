import type { ReactNode } from "react";
import type { Condition, Leaf, Signal } from "../../../api/ruleTypes";
import { Choice } from "../../../ui/controls/Choice";
import { DurationField } from "../../../ui/controls/DurationField";
import { NumberField } from "../../../ui/controls/NumberField";
import { Toggle } from "../../../ui/controls/Toggle";
import { bare, slashed } from "../../model/actions";
import { blank, KIND_WORDS } from "../../model/presets";
import { sensibleTimeout, topicOf } from "../../model/signals";
import classes from "../form/Editor.module.css";
import { useEditor } from "../form/EditorContext";
import { CompareFields } from "./CompareFields";
import { FieldPicker } from "./FieldPicker";
import { TopicPicker } from "./TopicPicker";

interface Props {
  leaf: Leaf;
  /** How it is judged right now. */
  now: ReactNode;
  onChange: (leaf: Condition) => void;
  tools: ReactNode;
}

type Kind = keyof typeof KIND_WORDS;

/** One leaf: what sort of thing, of which topic, which value of it, and how it is right now. */
export function LeafEditor({ leaf, now, onChange, tools }: Props) {
  const { graph } = useEditor();
  if (leaf.kind === "callable") {
    return (
      <div className={classes.leafHead}>
        <span>
          <code>{leaf.name}()</code> of the recipe: its code cannot be edited here.
        </span>
        {now}
        <span className={classes.spring} />
        {tools}
      </div>
    );
  }
  const signal: Signal =
    leaf.kind === "rate"
      ? { topic: leaf.topic, type: leaf.type ?? "", path: [], aggregate: null, timeout: 1 }
      : leaf.signal;
  const choose = (name: string) => {
    const topic = topicOf(graph, name);
    const type = topic?.type ?? "";
    const kept = type === signal.type ? signal : { ...signal, path: [], aggregate: null };
    const next = { ...kept, topic: bare(name), type, timeout: sensibleTimeout(topic) };
    onChange(
      leaf.kind === "rate"
        ? { ...leaf, topic: next.topic, type: type === "" ? null : type }
        : { ...leaf, signal: next },
    );
  };
  return (
    <>
      <div className={classes.leafHead}>
        <Choice
          className={classes.kind}
          aria-label="What sort of condition"
          data={Object.entries(KIND_WORDS).map(([value, label]) => ({ value, label }))}
          value={leaf.kind}
          onChange={(kind) => {
            if (kind !== leaf.kind) onChange(blank(kind as Kind, graph, signal));
          }}
        />
        <span className={classes.spring} />
        {tools}
      </div>
      <div className={classes.leafBody}>
        <TopicPicker topic={signal.topic} type={signal.type} onChange={choose} />
        <KindFields leaf={leaf} onChange={onChange} />
      </div>
      <div className={classes.leafFoot}>
        {now}
        {leaf.kind !== "rate" && leaf.kind !== "absent" && (
          <Timeout
            signal={leaf.signal}
            onChange={(timeout) =>
              onChange({ ...leaf, signal: { ...leaf.signal, timeout } } as Leaf)
            }
          />
        )}
      </div>
    </>
  );
}

function KindFields({ leaf, onChange }: { leaf: Leaf; onChange: (leaf: Leaf) => void }) {
  switch (leaf.kind) {
    case "compare":
      return <CompareFields leaf={leaf} onChange={onChange} />;
    case "changed":
      return (
        <>
          <FieldPicker
            signal={leaf.signal}
            onChange={(field) =>
              onChange({
                ...leaf,
                signal: { ...leaf.signal, path: field.path, aggregate: field.aggregate },
                deadband: field.kind === "int" || field.kind === "float" ? leaf.deadband : 0,
              })
            }
          />
          <NumberField
            label="by more than"
            min={0}
            value={leaf.deadband}
            onChange={(deadband) => onChange({ ...leaf, deadband })}
          />
        </>
      );
    case "absent":
      return (
        <>
          <DurationField
            label="for longer than"
            min={0.01}
            value={leaf.seconds}
            onChange={(seconds) => onChange({ ...leaf, seconds })}
          />
          <Toggle
            on={leaf.from_start}
            label="Silence from the start counts"
            onChange={(from_start) => onChange({ ...leaf, from_start })}
          >
            from the start too
          </Toggle>
        </>
      );
    case "rate": {
      const below = leaf.below !== null;
      const bound = leaf.below ?? leaf.above ?? 1;
      const put = (isBelow: boolean, hz: number) =>
        onChange({ ...leaf, below: isBelow ? hz : null, above: isBelow ? null : hz });
      return (
        <>
          <Choice
            label="comes"
            data={[
              { value: "below", label: "slower than" },
              { value: "above", label: "faster than" },
            ]}
            value={below ? "below" : "above"}
            onChange={(way) => put(way === "below", bound)}
          />
          <NumberField
            label="rate"
            suffix=" Hz"
            min={0.01}
            value={bound}
            onChange={(hz) => put(below, hz)}
          />
          <DurationField
            label="measured over"
            min={0.1}
            max={3600}
            value={leaf.window}
            onChange={(window) => onChange({ ...leaf, window })}
          />
        </>
      );
    }
    case "received":
    case "callable":
      return null;
  }
}

/** How long a value counts: silence is unknown, never false. */
function Timeout(props: { signal: Signal; onChange: (timeout: number | null) => void }) {
  const { signal, onChange } = props;
  const ages = signal.timeout !== null;
  return (
    <span className={classes.timeout}>
      <Toggle
        on={ages}
        label={`Unknown when older than a time: ${slashed(signal.topic)}`}
        onChange={(on) => onChange(on ? 1 : null)}
      >
        <span>unknown when older than</span>
      </Toggle>
      {signal.timeout !== null && (
        <DurationField
          aria-label="Seconds after which the value is unknown"
          inline
          min={0.01}
          value={signal.timeout}
          onChange={onChange}
        />
      )}
    </span>
  );
}
