import { Button, MultiSelect, Progress, SegmentedControl } from "@mantine/core";
import { useState } from "react";
import { drillReportAddress } from "../../api/drillsClient";
import type { Drill, DrillRoom, DrillSummary, Scenario } from "../../api/drillTypes";
import { reportOf } from "../../api/rulesClient";
import type { Table } from "../../api/ruleTypes";
import { useRobot } from "../../state/RobotContext";
import { Choice } from "../../ui/controls/Choice";
import { Problem } from "../../ui/Problem";
import page from "../../ui/page.module.css";
import { useRules } from "../context/RulesContext";
import { sentence } from "../model/words";
import { FindingList } from "../parts/FindingList";
import classes from "./Drill.module.css";
import { DriveList } from "./DriveList";
import { faultText, progressText, subjectText, tallyText, wishText } from "./drillText";
import { ScenarioEditor } from "./ScenarioEditor";
import { inWords, missing, newScenario } from "./scenario";
import { useDrill } from "./useDrill";

const COUNTS = [1, 4, 10, 20, 50, 100, 200];
const AT_ONCE = [
  { value: "1", label: "one in each drive" },
  { value: "2", label: "two in each drive" },
  { value: "3", label: "three in each drive" },
];

const LASTINGS = [
  { value: "0", label: "3 to 20 s" },
  { value: "0.25", label: "one in four to the end" },
  { value: "1", label: "to the end" },
];

/** Until the console has told, the choices stand where they will be: what is below does not move. */
const UNTOLD: DrillRoom = {
  refusal: null,
  remedy: "",
  recipe: "",
  own_world: null,
  robot: "",
  worlds: [],
  faults: [],
  most_drives: Number.POSITIVE_INFINITY,
  newest: null,
};

interface Props {
  table: Table;
  /** Whether the robot would take the table at all. */
  ready: boolean;
}

/** Does it recover better? The proposed rules and those in force, through the same faulted drives. */
export function DrillPanel({ table, ready }: Props) {
  const { room: told, drill, fresh, others, starting, error, start, cancel } = useDrill(table);
  const room = told ?? UNTOLD;
  const { wish, setWish } = useRules();
  const { count } = wish;
  const setScenario = (next: Scenario) => setWish((was) => ({ ...was, scenario: next }));
  const [faults, setFaults] = useState<string[]>([]);
  const [lasting, setLasting] = useState("0");
  const [each, setEach] = useState("1");
  const [chosen, setChosen] = useState<string | null>(null);
  const drawnIn = chosen ?? room.own_world ?? room.worlds[0]?.name ?? "";
  const scenario =
    wish.own && told !== null ? (wish.scenario ?? newScenario(drawnIn, room.robot)) : null;
  const world = scenario?.world ?? drawnIn;
  const options =
    scenario === null
      ? {
          faults: faults.length === 0 ? ["all"] : faults,
          faults_per_drive: Number(each),
          lasting: Number(lasting),
          world: drawnIn,
          drives: Number(count),
        }
      : { scenario, drives: Number(count) };
  const [asked, setAsked] = useState<string | null>(null);
  /** What is shown answers another question than the one that the form asks now. */
  const earlier = drill !== null && asked !== null && asked !== JSON.stringify(options);
  const lacks = scenario === null ? "" : missing(scenario);
  const running = drill?.state === "running";
  const locked = running || told === null;
  // A console that is silent is asked again: what is to be chosen stays where it will be.
  const silent = told === null && error?.status === 0;
  const refused = reportOf(error)?.findings.filter(({ level }) => level === "error") ?? [];
  return (
    <section className={page.section} aria-label="Drill" data-testid="drill">
      <h3>Drill: does it recover better?</h3>
      {(told !== null || error === null || silent) &&
        (room.refusal !== null ? (
          <p className={page.note} data-testid="drill-refusal">
            {room.refusal} {room.remedy}
          </p>
        ) : (
          <>
            <p className={page.muted}>
              {silent && "The console does not answer. "}
              {told === null
                ? "Asking the console what can be drilled…"
                : subjectText(room.recipe, scenario?.robot ?? room.robot, world, room.own_world)}
            </p>
            <SegmentedControl
              size="sm"
              aria-label="Which drives"
              data={[
                { value: "drawn", label: "Drives drawn by chance" },
                { value: "own", label: "One of my own" },
              ]}
              value={wish.own ? "own" : "drawn"}
              disabled={locked}
              data-testid="drill-which"
              onChange={(which) => setWish((was) => ({ ...was, own: which === "own" }))}
            />
            {scenario === null ? (
              <Options
                room={room}
                faults={faults}
                each={each}
                lasting={lasting}
                world={drawnIn}
                locked={locked}
                onFaults={setFaults}
                onEach={setEach}
                onLasting={setLasting}
                onWorld={setChosen}
              />
            ) : (
              <ScenarioEditor
                room={room}
                scenario={scenario}
                locked={locked}
                onChange={setScenario}
              />
            )}
            <Choice
              label={scenario === null ? "Drives under each" : "How often, with other noise"}
              data={COUNTS.filter(
                (most) => most <= room.most_drives && (most > 1 || scenario !== null),
              ).map(String)}
              value={count}
              disabled={locked}
              data-testid="drill-count"
              onChange={(often) => setWish((was) => ({ ...was, count: often }))}
            />
            {lacks !== "" && <p className={page.muted}>{lacks}</p>}
            <div className={page.line}>
              {running ? (
                <Button variant="default" onClick={cancel} data-testid="drill-cancel">
                  Cancel
                </Button>
              ) : (
                <Button
                  variant="default"
                  disabled={!ready || lacks !== "" || told === null}
                  loading={starting}
                  data-testid="drill-start"
                  onClick={() => {
                    setAsked(JSON.stringify(options));
                    start(options);
                  }}
                >
                  {drill === null || earlier ? "Drill" : "Drill again"}
                </Button>
              )}
            </div>
          </>
        ))}
      <Problem
        error={silent ? null : error && { title: inWords(error.title), remedy: error.remedy }}
        testId="drill-problem"
      />
      <FindingList findings={refused} />
      {/* What the one before has shown is not to be taken for an answer to what is asked now. */}
      {drill !== null && error === null && !starting && (
        <>
          {others && (
            <p className={page.note} data-testid="drill-others">
              {drill.by} began this drill
              {drill.report === null ? "" : `, of ${drill.report.recipe}`}: {wishText(drill.wish)}.
            </p>
          )}
          {earlier && !running && (
            <p className={page.note} data-testid="drill-earlier">
              What follows is of the drives that were asked for before.
            </p>
          )}
          <Outcome drill={drill} fresh={fresh} />
        </>
      )}
    </section>
  );
}

interface OptionsProps {
  room: DrillRoom;
  faults: string[];
  each: string;
  lasting: string;
  world: string;
  locked: boolean;
  onFaults: (faults: string[]) => void;
  onEach: (each: string) => void;
  onLasting: (lasting: string) => void;
  onWorld: (world: string) => void;
}

function Options(props: OptionsProps) {
  const { room, faults, each, lasting, world, locked } = props;
  const { state } = useRobot();
  const components = state?.components.map(({ name }) => name) ?? [];
  const kinds = room.faults.map(({ name }) => ({ value: name, label: faultText(name) }));
  const named = room.faults
    .filter(({ parameter }) => parameter === "NAME")
    .flatMap(({ name }) => components.map((component) => `${name}:${component}`))
    .map((name) => ({ value: name, label: faultText(name) }));
  return (
    <div className={classes.options}>
      <MultiSelect
        className={classes.faults}
        size="sm"
        label="What breaks"
        placeholder={faults.length === 0 ? "Any fault" : ""}
        searchable
        data={
          named.length === 0
            ? kinds
            : [
                { group: "Whichever it strikes", items: kinds },
                { group: "One component", items: named },
              ]
        }
        value={faults}
        disabled={locked}
        clearable
        data-testid="drill-faults"
        onChange={props.onFaults}
      />
      <Choice
        label="How many"
        data={AT_ONCE}
        value={each}
        disabled={locked}
        data-testid="drill-each"
        onChange={props.onEach}
      />
      <Choice
        label="For how long"
        data={LASTINGS}
        value={lasting}
        disabled={locked}
        data-testid="drill-lasting"
        onChange={props.onLasting}
      />
      <Choice
        label="Where"
        data={room.worlds.map(({ name }) => name)}
        value={world}
        disabled={locked}
        data-testid="drill-world"
        onChange={props.onWorld}
      />
    </div>
  );
}

/** How far it is, or what came of it. */
export function Outcome({ drill, fresh }: { drill: Drill; fresh: boolean }) {
  if (drill.state === "running") {
    return (
      <div className={classes.progress} data-testid="drill-progress">
        <Progress
          value={(100 * drill.done) / Math.max(1, drill.total)}
          aria-label="Drill"
          transitionDuration={120}
        />
        <span className={page.muted}>{progressText(drill)}</span>
      </div>
    );
  }
  if (drill.report === null) {
    return drill.state === "canceled" ? (
      <p className={page.note} data-testid="drill-canceled">
        {drill.error}
      </p>
    ) : (
      <p className={page.problem} role="alert" data-testid="drill-failed">
        {drill.error}
      </p>
    );
  }
  return <Summary drill={drill} report={drill.report} fresh={fresh} />;
}

function Summary(props: { drill: Drill; report: DrillSummary; fresh: boolean }) {
  const { drill, report, fresh } = props;
  const { view } = useRules();
  const inForce = view?.active ?? drill.revision;
  return (
    <div className={classes.report} data-testid="drill-report">
      {!fresh && (
        <p className={page.note}>The rules have changed since: this is of the ones before.</p>
      )}
      {inForce !== drill.revision && (
        <p className={page.note}>
          It compares with revision {drill.revision}, and revision {inForce} is in force.
        </p>
      )}
      <p className={classes.sentence} data-testid="drill-sentence" data-verdict={report.verdict}>
        {report.sentence}
      </p>
      {report.chance !== "" && (
        <p className={page.muted} data-testid="drill-chance">
          {report.chance}
        </p>
      )}
      {report.notes.map((note) => (
        <p key={note} className={page.note} data-testid="drill-note">
          {sentence(note)}
        </p>
      ))}
      <p className={page.muted}>
        {tallyText(report.drives)}, against {report.in_force}.{" "}
        <a className={page.link} href={drillReportAddress(drill.id)} download>
          Download the report
        </a>
      </p>
      <DriveList drill={drill.id} drives={report.drives} />
    </div>
  );
}
