import { Button, MultiSelect, Progress } from "@mantine/core";
import { useState } from "react";
import { drillReportAddress } from "../../api/drillsClient";
import type { Drill, DrillRoom, DrillSummary } from "../../api/drillTypes";
import { reportOf } from "../../api/rulesClient";
import type { Table } from "../../api/ruleTypes";
import { Choice } from "../../ui/controls/Choice";
import { Problem } from "../../ui/Problem";
import page from "../../ui/page.module.css";
import { useRules } from "../context/RulesContext";
import { FindingList } from "../parts/FindingList";
import classes from "./Drill.module.css";
import { DriveList } from "./DriveList";
import { faultText, progressText, subjectText, tallyText } from "./drillText";
import { useDrill } from "./useDrill";

const COUNTS = [4, 10, 20, 50, 100, 200];
const AT_ONCE = [
  { value: "1", label: "one in each drive" },
  { value: "2", label: "two in each drive" },
  { value: "3", label: "three in each drive" },
];

interface Props {
  table: Table;
  /** Whether the robot would take the table at all. */
  ready: boolean;
}

/** Does it recover better? The proposed rules and those in force, through the same faulted drives. */
export function DrillPanel({ table, ready }: Props) {
  const { room, drill, fresh, starting, error, start, cancel } = useDrill(table);
  const [faults, setFaults] = useState<string[]>([]);
  const [each, setEach] = useState("1");
  const [count, setCount] = useState("20");
  const [chosen, setChosen] = useState<string | null>(null);
  const world = chosen ?? room?.own_world ?? room?.worlds[0]?.name ?? "";
  const running = drill?.state === "running";
  const refused = reportOf(error)?.findings.filter(({ level }) => level === "error") ?? [];
  return (
    <section className={page.section} aria-label="Drill" data-testid="drill">
      <h3>Drill: does it recover better?</h3>
      {room !== null &&
        (room.refusal !== null ? (
          <p className={page.note} data-testid="drill-refusal">
            {room.refusal} {room.remedy}
          </p>
        ) : (
          <>
            <p className={page.muted}>{subjectText(room.recipe, world, room.own_world)}</p>
            <Options
              room={room}
              faults={faults}
              each={each}
              count={count}
              world={world}
              locked={running}
              onFaults={setFaults}
              onEach={setEach}
              onCount={setCount}
              onWorld={setChosen}
            />
            <div className={page.line}>
              {running ? (
                <Button variant="default" onClick={cancel} data-testid="drill-cancel">
                  Cancel
                </Button>
              ) : (
                <Button
                  variant="default"
                  disabled={!ready}
                  loading={starting}
                  data-testid="drill-start"
                  onClick={() =>
                    start({
                      faults: faults.length === 0 ? ["all"] : faults,
                      faults_per_drive: Number(each),
                      world,
                      drives: Number(count),
                    })
                  }
                >
                  {drill === null ? "Drill" : "Drill again"}
                </Button>
              )}
            </div>
          </>
        ))}
      <Problem error={error} testId="drill-problem" />
      <FindingList findings={refused} />
      {drill !== null && <Outcome drill={drill} fresh={fresh} />}
    </section>
  );
}

interface OptionsProps {
  room: DrillRoom;
  faults: string[];
  each: string;
  count: string;
  world: string;
  locked: boolean;
  onFaults: (faults: string[]) => void;
  onEach: (each: string) => void;
  onCount: (count: string) => void;
  onWorld: (world: string) => void;
}

function Options(props: OptionsProps) {
  const { room, faults, each, count, world, locked } = props;
  return (
    <div className={classes.options}>
      <MultiSelect
        className={classes.faults}
        size="sm"
        label="What breaks"
        placeholder={faults.length === 0 ? "Any fault" : ""}
        data={room.faults.map(({ name }) => ({ value: name, label: faultText(name) }))}
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
        label="Drives under each"
        data={COUNTS.filter((most) => most <= room.most_drives).map(String)}
        value={count}
        disabled={locked}
        data-testid="drill-count"
        onChange={props.onCount}
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

function Outcome({ drill, fresh }: { drill: Drill; fresh: boolean }) {
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
