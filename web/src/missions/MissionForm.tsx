import { Button, Chip, TextInput } from "@mantine/core";
import { IconArrowDown, IconArrowUp, IconTrash } from "@tabler/icons-react";
import { type FormEvent, useEffect, useId, useRef, useState } from "react";
import type { ApiError } from "../api/errors";
import type { Mission, MissionSave, Place, Waypoint } from "../api/types";
import { weekdayText } from "../texts/dates";
import { type Phrase, t } from "../texts/text";
import { broughtIntoView } from "../ui/broughtIntoView";
import { Choice } from "../ui/controls/Choice";
import { IconButton } from "../ui/controls/IconButton";
import { NumberField } from "../ui/controls/NumberField";
import { Picker } from "../ui/controls/Picker";
import { Toggle } from "../ui/controls/Toggle";
import { Problem } from "../ui/Problem";
import classes from "./Missions.module.css";
import { beginning, keepDraft, keptDraft } from "./missionDraft";
import { missionProblem, nameOf, WEEK } from "./missionText";
import { TaskList } from "./TaskList";

interface Props {
  /** To begin with; null for a new one. */
  mission: Mission | null;
  /** Of the map that the robot has now. */
  places: Place[];
  busy: boolean;
  error: ApiError | null;
  onSave: (mission: MissionSave) => void;
  /** Close it; what was typed is kept. */
  onClose: () => void;
  /** Close it, and forget what was typed. */
  onLeave: () => void;
}

const FAILURES: { value: string; label: Phrase }[] = [
  { value: "pause", label: "wait for a person" },
  { value: "skip", label: "leave it out and go on" },
  { value: "end", label: "end the mission" },
];
const ALL_DAYS = [0, 1, 2, 3, 4, 5, 6];

/** The places of a mission in their order, and what is done at each. */
export function MissionForm({ mission, places, busy, error, onSave, onClose, onLeave }: Props) {
  const [kept] = useState(() => keptDraft(mission));
  const [draft, setDraft] = useState<MissionSave>(kept ?? beginning(mission));
  const [asked, setAsked] = useState(false);
  const [again, setAgain] = useState(draft.rounds !== 1);
  const atId = useId();
  const next = useRef<HTMLDivElement>(null);
  const count = draft.waypoints.length;
  const before = useRef(count);
  // A place that is added pushes it down; where one goes on is to stay in sight.
  useEffect(() => {
    if (count > before.current) broughtIntoView(next.current);
    before.current = count;
  }, [count]);
  const change = (part: Partial<MissionSave>) => {
    const next = { ...draft, ...part };
    setDraft(next);
    keepDraft(mission, next);
  };
  const wrong = missionProblem(draft, places);
  const { waypoints, schedule } = draft;
  const rounds = draft.rounds ?? 1;
  const put = (index: number, waypoint: Waypoint) =>
    change({ waypoints: waypoints.map((each, at) => (at === index ? waypoint : each)) });
  const move = (index: number, by: number) => {
    const next = [...waypoints];
    const [taken] = next.splice(index, 1);
    if (taken !== undefined) next.splice(index + by, 0, taken);
    change({ waypoints: next });
  };
  const options = places.map(({ id, name }) => ({ value: String(id), label: name }));
  const submit = (event: FormEvent) => {
    event.preventDefault();
    setAsked(true);
    if (wrong === null) onSave({ ...draft, name: draft.name.trim() });
  };
  return (
    <form
      ref={broughtIntoView}
      className={classes.form}
      onSubmit={submit}
      aria-label={mission === null ? t("New mission") : t("Change {name}", { name: mission.name })}
      noValidate
      onKeyDown={(event) => {
        if (event.key !== "Escape" || event.defaultPrevented) return;
        event.stopPropagation();
        onClose();
      }}
    >
      {kept !== null && (
        <p className={classes.note} data-testid="mission-kept">
          {t("As you left it: it is not saved yet.")}
        </p>
      )}
      <TextInput
        label={t("Name")}
        value={draft.name}
        autoFocus
        autoComplete="off"
        onChange={(event) => change({ name: event.currentTarget.value })}
        data-testid="mission-name"
      />
      <ol className={classes.waypoints} aria-label={t("Places of the mission")}>
        {waypoints.map((waypoint, index) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: a waypoint is known by its place in the list
          <li key={index} className={classes.waypoint} data-testid={`waypoint-${index}`}>
            <div className={classes.head}>
              <span className={classes.number}>{index + 1}</span>
              <Choice
                aria-label={t("Place {index}", { index: index + 1 })}
                searchable
                data={
                  nameOf(places, waypoint.place) === null
                    ? [...options, { value: String(waypoint.place), label: "a place that is gone" }]
                    : options
                }
                value={String(waypoint.place)}
                onChange={(id) => put(index, { ...waypoint, place: Number(id) })}
              />
              <IconButton
                label={t("Place {index} earlier", { index: index + 1 })}
                disabled={index === 0}
                onClick={() => move(index, -1)}
                Icon={IconArrowUp}
              />
              <IconButton
                label={t("Place {index} later", { index: index + 1 })}
                disabled={index === waypoints.length - 1}
                onClick={() => move(index, 1)}
                Icon={IconArrowDown}
              />
              <IconButton
                label={t("Remove place {index}", { index: index + 1 })}
                onClick={() => change({ waypoints: waypoints.filter((_, at) => at !== index) })}
                Icon={IconTrash}
              />
            </div>
            <TaskList
              tasks={waypoint.tasks ?? []}
              where={`place ${index + 1}`}
              asked={asked}
              onChange={(tasks) => put(index, { ...waypoint, tasks })}
            />
          </li>
        ))}
      </ol>
      <div ref={next}>
        <Picker
          aria-label={t("Add a place")}
          placeholder={waypoints.length === 0 ? t("Choose the first place") : t("And then to …")}
          data={options}
          nothingFoundMessage={t("No place is called like that")}
          onPick={(id) => change({ waypoints: [...waypoints, { place: Number(id), tasks: [] }] })}
          data-testid="add-waypoint"
        />
      </div>
      <Toggle
        on={again}
        label={t("Again and again")}
        onChange={(on) => {
          setAgain(on);
          change({ rounds: on ? 0 : 1 });
        }}
        testId="mission-again"
      >
        {t("again and again")}
      </Toggle>
      {again && (
        <NumberField
          label={t("Rounds; 0 until somebody cancels it")}
          min={0}
          max={1000}
          allowDecimal={false}
          value={rounds}
          onChange={(next) => change({ rounds: next })}
          testId="mission-rounds"
        />
      )}
      <div className={classes.fields}>
        <Choice
          label={t("If a place cannot be reached")}
          data={FAILURES.map(({ value, label }) => ({ value, label: t(label) }))}
          value={draft.on_failure ?? "pause"}
          onChange={(next) => change({ on_failure: next as MissionSave["on_failure"] })}
        />
        <NumberField
          label={t("After tries")}
          w={88}
          min={1}
          max={10}
          allowDecimal={false}
          value={draft.attempts ?? 1}
          onChange={(attempts) => change({ attempts })}
        />
      </div>
      <Toggle
        on={schedule != null}
        label={t("It begins by itself")}
        onChange={(on) => change({ schedule: on ? { at: "08:00", days: ALL_DAYS } : null })}
        testId="mission-scheduled"
      >
        {t("it begins by itself")}
      </Toggle>
      {schedule != null && (
        <>
          <TextInput
            id={atId}
            label={t("At (the robot's time)")}
            type="time"
            w={140}
            value={schedule.at}
            onChange={(event) =>
              change({ schedule: { ...schedule, at: event.currentTarget.value } })
            }
          />
          <fieldset className={classes.days} aria-label={t("Days on which it begins")}>
            {WEEK.map((day) => {
              const name = weekdayText(day, "long");
              const days = schedule.days ?? ALL_DAYS;
              const on = days.includes(day);
              const next = on ? days.filter((each) => each !== day) : [...days, day].sort();
              return (
                <Chip
                  key={name}
                  size="xs"
                  checked={on}
                  aria-label={name}
                  onChange={() => change({ schedule: { ...schedule, days: next } })}
                >
                  {name.slice(0, 2)}
                </Chip>
              );
            })}
          </fieldset>
        </>
      )}
      {asked && wrong !== null && (
        <p className={classes.warning} role="alert">
          {wrong}
        </p>
      )}
      <Problem error={error} testId="mission-form-problem" />
      <div className={classes.buttons}>
        <Button type="submit" size="compact-md" loading={busy} data-testid="mission-save">
          {t("Save")}
        </Button>
        <Button variant="default" size="compact-md" onClick={onLeave} data-testid="mission-leave">
          {t("Leave it")}
        </Button>
      </div>
    </form>
  );
}
