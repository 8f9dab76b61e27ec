import type { Mode, RuleEvent, Trigger } from "../../api/ruleTypes";
import { Choice } from "../../ui/controls/Choice";
import { DurationField } from "../../ui/controls/DurationField";
import { NumberField } from "../../ui/controls/NumberField";
import { Toggle } from "../../ui/controls/Toggle";
import page from "../../ui/page.module.css";
import { findingsAt } from "../changes/findings";
import { blank } from "../model/presets";
import { TRIGGER_WORDS } from "../model/words";
import { FindingList } from "../parts/FindingList";
import { ConditionEditor } from "./condition/ConditionEditor";
import classes from "./form/Editor.module.css";
import { useEditor } from "./form/EditorContext";
import { VerdictLine } from "./form/Probe";

interface Props {
  event: RuleEvent;
  onChange: (event: RuleEvent) => void;
}

const MODES: { value: Mode["kind"]; label: string }[] = [
  { value: "single", label: "are dropped and counted" },
  { value: "queued", label: "wait in a queue" },
  { value: "restart", label: "start the actions again" },
  { value: "parallel", label: "run beside it" },
];

/** How the truth of the condition over time becomes firings. */
export function TimingFields({ event, onChange }: Props) {
  const { findings, graph } = useEditor();
  const put = (part: Partial<RuleEvent>) => onChange({ ...event, ...part });
  const { mode, max_rate: limit } = event;
  return (
    <section className={page.section} aria-label="How often">
      <div className={classes.grid}>
        <Choice
          label="It fires"
          className={classes.wide}
          data={Object.entries(TRIGGER_WORDS).map(([value, label]) => ({ value, label }))}
          value={event.trigger}
          onChange={(trigger) => put({ trigger: trigger as Trigger })}
          data-testid="trigger"
        />
        <DurationField
          label="once true for"
          value={event.hold}
          onChange={(hold) => put({ hold })}
          testId="hold"
        />
        <DurationField
          label="cooldown after it"
          value={event.cooldown}
          onChange={(cooldown) => put({ cooldown })}
          testId="cooldown"
        />
        <Choice
          label="While its actions run, further ones"
          className={classes.wide}
          data={MODES}
          value={mode.kind}
          onChange={(kind) => {
            if (kind === "queued" || kind === "parallel") put({ mode: { kind, size: 10 } });
            else if (kind === "single" || kind === "restart") put({ mode: { kind } });
          }}
        />
        {(mode.kind === "queued" || mode.kind === "parallel") && (
          <NumberField
            label="up to"
            min={1}
            max={1000}
            allowDecimal={false}
            value={mode.size}
            onChange={(size) => put({ mode: { ...mode, size } })}
          />
        )}
      </div>
      <FindingList
        findings={[
          ...findingsAt(findings, "event.hold"),
          ...findingsAt(findings, "event.cooldown"),
        ]}
      />
      <div className={page.line}>
        <Toggle on={event.once} label="Only once" onChange={(once) => put({ once })} testId="once">
          only once, until it is reset or the stack starts again
        </Toggle>
        {event.trigger === "edge" && (
          <Toggle
            on={event.first_true_is_edge}
            label="True from the start counts"
            onChange={(first_true_is_edge) => put({ first_true_is_edge })}
          >
            true from the start counts
          </Toggle>
        )}
      </div>
      <div className={page.line}>
        <Toggle
          on={limit !== null}
          label="Limit how often: latch beyond"
          onChange={(on) => put({ max_rate: on ? { count: 5, window: 60 } : null })}
        >
          limit how often: latch beyond
        </Toggle>
        {limit !== null && (
          <>
            <NumberField
              aria-label="Number of firings"
              suffix=" firings"
              w={120}
              min={1}
              max={1000}
              allowDecimal={false}
              value={limit.count}
              onChange={(count) => put({ max_rate: { ...limit, count } })}
            />
            in
            <DurationField
              aria-label="Seconds for them"
              inline
              min={0.01}
              value={limit.window}
              onChange={(window) => put({ max_rate: { ...limit, window } })}
            />
          </>
        )}
      </div>
      <Toggle
        on={event.clear !== null}
        label="Fire again only after another condition was true"
        onChange={(on) => put({ clear: on ? blank("compare", graph, null) : null })}
      >
        fire again only after another condition was true
      </Toggle>
      {event.clear !== null && (
        <>
          <ConditionEditor
            root="event.clear"
            condition={event.clear}
            onChange={(clear) => put({ clear })}
          />
          <VerdictLine of="clear" />
        </>
      )}
    </section>
  );
}
