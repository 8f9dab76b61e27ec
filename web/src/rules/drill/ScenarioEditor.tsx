import { Button, FileButton, SegmentedControl, Select } from "@mantine/core";
import { IconX } from "@tabler/icons-react";
import { useMutation } from "@tanstack/react-query";
import { Fragment, useState } from "react";
import {
  getDrillWorld,
  readScenarioFile,
  type Stretch,
  scenarioOfRecording,
} from "../../api/drillsClient";
import type { DrillPlace, DrillRoom, Scenario } from "../../api/drillTypes";
import { useAsked } from "../../api/queries";
import { listRecordings } from "../../api/recordingsClient";
import { placesHere } from "../../places/placeText";
import { usePlaces } from "../../places/usePlaces";
import { useRobot } from "../../state/RobotContext";
import { Choice } from "../../ui/controls/Choice";
import { DurationField } from "../../ui/controls/DurationField";
import { IconButton } from "../../ui/controls/IconButton";
import { NumberField } from "../../ui/controls/NumberField";
import { Problem } from "../../ui/Problem";
import page from "../../ui/page.module.css";
import classes from "./Drill.module.css";
import { FaultRow } from "./FaultRow";
import { ScenarioMap } from "./ScenarioMap";
import {
  DEGREES,
  faultAt,
  goalAt,
  goalSentAt,
  inWorld,
  MOST_FAULTS,
  MOST_GOALS,
  outOfPlace,
  type Spot,
  startAt,
  withoutFault,
  withoutGoal,
} from "./scenario";

const WORDS = { stop: "presses", release: "releases" } as const;
const EDGES = { begin: "Begin of the stretch", end: "End of the stretch" } as const;

interface Props {
  room: DrillRoom;
  scenario: Scenario;
  locked: boolean;
  onChange: (scenario: Scenario) => void;
}

/** What was there before something took its place. */
interface Before {
  scenario: Scenario;
  by: string;
}

/** One drive as a person wants it: from where, where to, and what breaks when. */
export function ScenarioEditor({ room, scenario, locked, onChange }: Props) {
  const { data: place, error } = useAsked({
    key: ["drill-world", scenario.world],
    ask: (signal) => getDrillWorld(scenario.world, signal),
  });
  const [before, setBefore] = useState<Before | null>(null);
  const [takenBack, setTakenBack] = useState(0);
  const change = (next: Scenario) => {
    setBefore(null);
    onChange(next);
  };
  /** What takes the place of all that a person has made up can be taken back. */
  const replace = (next: Scenario, by: string) => {
    const worth = next !== scenario && scenario.goals.length + scenario.faults.length > 0;
    setBefore(worth ? { scenario, by } : null);
    onChange(next);
  };
  return (
    <div className={classes.scenario} data-testid="scenario">
      <Sources key={takenBack} locked={locked} onTaken={replace} />
      {before !== null && (
        <div className={page.line} data-testid="scenario-replaced">
          <span>{before.by} took the place of what was here.</span>
          <button
            type="button"
            className={page.more}
            disabled={locked}
            onClick={() => {
              setTakenBack(takenBack + 1);
              change(before.scenario);
            }}
          >
            Take that back
          </button>
        </div>
      )}
      <div className={page.pair}>
        <Choice
          label="Where"
          data={room.worlds.map(({ name }) => name)}
          value={scenario.world}
          disabled={locked}
          data-testid="scenario-world"
          onChange={(world) => replace(inWorld(scenario, world), `The floor of ${world}`)}
        />
        <DurationField
          label="Ends after"
          value={scenario.limit}
          min={5}
          max={3600}
          disabled={locked}
          testId="scenario-limit"
          onChange={(limit) => change({ ...scenario, limit })}
        />
      </div>
      <Problem error={error} />
      {place !== null && (
        <Ways
          place={place}
          own={room.own_world === scenario.world}
          scenario={scenario}
          locked={locked}
          onChange={change}
        />
      )}
      <Faults
        room={room}
        doorways={place?.doorways ?? []}
        scenario={scenario}
        locked={locked}
        onChange={change}
      />
      {scenario.operators.length > 0 && (
        <div className={page.line} data-testid="scenario-operators">
          <span>
            {scenario.operators
              .map(({ at, does, by }) => `${by} ${WORDS[does]} STOP at ${at} s`)
              .join("; ")}
          </span>
          <button
            type="button"
            className={page.more}
            disabled={locked}
            onClick={() => change({ ...scenario, operators: [] })}
          >
            leave that out
          </button>
        </div>
      )}
    </div>
  );
}

interface SourcesProps {
  locked: boolean;
  onTaken: (scenario: Scenario, by: string) => void;
}

/** What has happened, or was written down before, is the best of scenarios. */
function Sources({ locked, onTaken }: SourcesProps) {
  const { data } = useAsked({ key: ["recordings"], ask: listRecordings });
  const kept = data?.recordings.filter(({ end }) => end !== null) ?? [];
  const [stretch, setStretch] = useState<Required<Stretch> | null>(null);
  const file = useMutation({
    mutationFn: async (chosen: File) => readScenarioFile(await chosen.text()),
    onSuccess: (scenario, { name }) => {
      setStretch(null);
      recording.reset();
      onTaken(scenario, name);
    },
  });
  const recording = useMutation({
    mutationFn: scenarioOfRecording,
    onSuccess: ({ scenario }, { recording }) => onTaken(scenario, recording),
  });
  const busy = locked || recording.isPending;
  const chosen = kept.find(({ name }) => name === stretch?.recording);
  const length = chosen === undefined ? 0 : lengthOf(chosen);
  return (
    <>
      <div className={page.line}>
        {kept.length > 0 && (
          <Select
            size="sm"
            aria-label="From a kept recording"
            placeholder={recording.isPending ? "Reading it…" : "From a kept recording…"}
            data={kept.map(({ name }) => name)}
            value={null}
            disabled={busy}
            data-testid="scenario-recording"
            onChange={(name) => {
              const chosen = kept.find((each) => each.name === name);
              if (chosen === undefined) return;
              file.reset();
              setStretch({ recording: chosen.name, begin: 0, end: lengthOf(chosen) });
              recording.mutate({ recording: chosen.name });
            }}
          />
        )}
        <FileButton
          accept=".yaml,.yml"
          onChange={(chosen) => {
            if (chosen !== null) file.mutate(chosen);
          }}
        >
          {(button) => (
            <Button
              {...button}
              size="sm"
              variant="default"
              disabled={locked}
              data-testid="scenario-file"
            >
              From a file…
            </Button>
          )}
        </FileButton>
      </div>
      {stretch !== null && length > 0 && (
        <div className={classes.spot} data-testid="scenario-stretch">
          <span>Of {stretch.recording}, from</span>
          {(["begin", "end"] as const).map((edge) => (
            <Fragment key={edge}>
              {edge === "end" && <span>to</span>}
              <DurationField
                aria-label={EDGES[edge]}
                className={classes.time}
                value={stretch[edge]}
                max={length}
                disabled={busy}
                testId={`stretch-${edge}`}
                onChange={(at) => setStretch({ ...stretch, [edge]: at })}
              />
            </Fragment>
          ))}
          <Button
            size="sm"
            variant="default"
            disabled={busy || stretch.end <= stretch.begin}
            data-testid="stretch-take"
            onClick={() => recording.mutate(stretch)}
          >
            Take this stretch
          </Button>
        </div>
      )}
      <Problem error={file.error ?? recording.error} testId="scenario-problem" />
      {recording.data !== undefined && (
        <p className={page.muted} data-testid="scenario-remarks">
          {[recording.data.sentence, ...recording.data.remarks].join(". ")}.
        </p>
      )}
    </>
  );
}

/** Whole seconds, and all of it. */
const lengthOf = ({ begin, end }: { begin: number | null; end: number | null }) =>
  Math.ceil((end ?? 0) - (begin ?? 0));

interface WaysProps {
  place: DrillPlace;
  /** Whether the robot at hand drives in this world, so that its places are those of the map. */
  own: boolean;
  scenario: Scenario;
  locked: boolean;
  onChange: (scenario: Scenario) => void;
}

/** Start and goals, on the map and in figures. */
function Ways({ place, own, scenario, locked, onChange }: WaysProps) {
  const [setting, setSetting] = useState<"start" | "goal">("goal");
  const { state } = useRobot();
  const { list } = usePlaces();
  const [x = 0, y = 0, yaw = 0] = place.start;
  const start = scenario.start ?? { x, y, yaw };
  const pose = own ? (state?.pose ?? null) : null;
  const places = own && list !== null ? placesHere(list.places) : [];
  const wrong = outOfPlace(scenario, place);
  const press = (spot: Spot) =>
    setting === "start"
      ? onChange(startAt(scenario, { ...spot, yaw: start.yaw }))
      : onChange(goalAt(scenario, Math.min(scenario.goals.length, MOST_GOALS - 1), spot));
  return (
    <>
      <SegmentedControl
        size="sm"
        aria-label="A press on the map sets"
        data={[
          { value: "start", label: "Press: start" },
          { value: "goal", label: "Press: next goal" },
        ]}
        value={setting}
        disabled={locked}
        data-testid="scenario-setting"
        onChange={(next) => setSetting(next === "start" ? "start" : "goal")}
      />
      {wrong !== "" && (
        <p className={page.note} role="status" data-testid="scenario-wrong">
          {wrong}
        </p>
      )}
      <ScenarioMap place={place} scenario={scenario} locked={locked} onPress={press} />
      <div className={classes.spot} data-testid="scenario-start-fields">
        <span>Start</span>
        <Spots
          name="start"
          spot={start}
          locked={locked}
          onChange={(spot) => onChange(startAt(scenario, { ...start, ...spot }))}
        />
        <NumberField
          aria-label="Heading of the start in degrees"
          suffix="°"
          value={Math.round(start.yaw * DEGREES)}
          min={-360}
          max={360}
          disabled={locked}
          testId="start-heading"
          onChange={(degrees) => onChange(startAt(scenario, { ...start, yaw: degrees / DEGREES }))}
        />
        {pose !== null && (
          <button
            type="button"
            className={page.more}
            disabled={locked}
            data-testid="start-here"
            onClick={() => onChange(startAt(scenario, pose))}
          >
            where the robot is now
          </button>
        )}
      </div>
      {scenario.goals.map((goal, index) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: a goal is known by its place in the list
        <div key={index} className={classes.spot}>
          <span>{scenario.goals.length === 1 ? "Goal" : `Goal ${index + 1}`}</span>
          <Spots
            name={`goal ${index + 1}`}
            spot={goal}
            locked={locked}
            onChange={(spot) => onChange(goalAt(scenario, index, spot))}
          />
          {index === 0 || goal.at !== null ? (
            <>
              <span>sent after</span>
              <DurationField
                aria-label={`When goal ${index + 1} is sent`}
                className={classes.time}
                value={goal.at ?? 0}
                max={3600}
                disabled={locked}
                testId={`goal-${index + 1}-at`}
                onChange={(at) => onChange(goalSentAt(scenario, index, at))}
              />
            </>
          ) : (
            <span className={page.muted}>when the one before has ended</span>
          )}
          <IconButton
            label={`Remove goal ${index + 1}`}
            Icon={IconX}
            disabled={locked}
            onClick={() => onChange(withoutGoal(scenario, index))}
          />
        </div>
      ))}
      {places.length > 0 && scenario.goals.length < MOST_GOALS && (
        <Select
          size="sm"
          aria-label="Goal at a place"
          placeholder="Goal at a place…"
          searchable
          data={places.map(({ id, name }) => ({ value: String(id), label: name }))}
          value={null}
          disabled={locked}
          data-testid="scenario-place"
          onChange={(id) => {
            const found = places.find((each) => String(each.id) === id);
            if (found) onChange(goalAt(scenario, scenario.goals.length, found.pose));
          }}
        />
      )}
    </>
  );
}

interface SpotsProps {
  name: string;
  spot: Spot;
  locked: boolean;
  onChange: (spot: Spot) => void;
}

function Spots({ name, spot, locked, onChange }: SpotsProps) {
  return (["x", "y"] as const).map((axis) => (
    <NumberField
      key={axis}
      aria-label={`${axis} of ${name} in metres`}
      leftSection={axis}
      suffix=" m"
      decimalScale={3}
      value={spot[axis]}
      min={-1000}
      max={1000}
      disabled={locked}
      testId={`${name.replace(" ", "-")}-${axis}`}
      onChange={(value) => onChange({ x: spot.x, y: spot.y, [axis]: value })}
    />
  ));
}

function Faults(props: Props & { doorways: readonly string[] }) {
  const { room, doorways, scenario, locked, onChange } = props;
  const { state } = useRobot();
  const components = state?.components.map(({ name }) => name) ?? [];
  const { faults } = scenario;
  const last = faults.at(-1);
  const next = last === undefined ? 10 : last.at + last.duration + 10;
  return (
    <>
      {faults.length > 0 && (
        <ul className={classes.faultList}>
          {faults.map((fault, index) => (
            <FaultRow
              // biome-ignore lint/suspicious/noArrayIndexKey: a fault is known by its place here
              key={index}
              number={index + 1}
              fault={fault}
              kinds={room.faults}
              doorways={doorways}
              components={components}
              locked={locked}
              onChange={(changed) => onChange(faultAt(scenario, index, changed))}
              onRemove={() => onChange(withoutFault(scenario, index))}
            />
          ))}
        </ul>
      )}
      {faults.length < MOST_FAULTS && (
        <div className={page.line}>
          <Button
            size="sm"
            variant="default"
            disabled={locked}
            data-testid="scenario-add-fault"
            onClick={() =>
              onChange(
                faultAt(scenario, faults.length, { name: "way_blocked", at: next, duration: 10 }),
              )
            }
          >
            {faults.length === 0 ? "Something breaks" : "Something else breaks"}
          </Button>
        </div>
      )}
    </>
  );
}
