import { Button, Progress } from "@mantine/core";
import { useState } from "react";
import { useAsked } from "../../api/queries";
import { listRecordings } from "../../api/recordingsClient";
import type { Table } from "../../api/ruleTypes";
import { Choice } from "../../ui/controls/Choice";
import { Problem } from "../../ui/Problem";
import page from "../../ui/page.module.css";
import { STRETCHES, secondsText, sentence } from "../model/words";
import { BacktestTimeline } from "./BacktestTimeline";
import classes from "./Review.module.css";
import { type BacktestRun, useBacktest } from "./useBacktest";

/** A recording that was kept is known by its name, behind this. */
const KEPT = "kept ";

interface Props {
  table: Table;
  names: ReadonlyMap<string, string>;
  /** Whether the robot would take the table at all. */
  ready: boolean;
}

/** What the rules would have done on what the robot has just lived through. */
export function BacktestPanel({ table, names, ready }: Props) {
  const [over, setOver] = useState("300");
  const kept = useKept();
  const { run, start, cancel } = useBacktest();
  const ended = run === null || run.over;
  const begin = () =>
    over.startsWith(KEPT)
      ? start(table, over.slice(KEPT.length), 0)
      : start(table, "", Number(over));
  return (
    <section className={page.section} aria-label="Back-test">
      <h3>Back-test first</h3>
      <div className={page.line}>
        <span className={page.muted}>
          What would it have done, had it been applied at the start of
        </span>
        <Choice
          aria-label="Over which stretch"
          data={
            kept.length === 0
              ? STRETCHES
              : [
                  { group: "The flight recorder", items: STRETCHES },
                  {
                    group: "Kept recordings",
                    items: kept.map((name) => ({ value: `${KEPT}${name}`, label: name })),
                  },
                ]
          }
          value={over}
          data-testid="backtest-over"
          onChange={setOver}
        />
        {ended ? (
          <Button variant="default" disabled={!ready} onClick={begin} data-testid="backtest-start">
            {run === null ? "Back-test" : "Again"}
          </Button>
        ) : (
          <Button variant="default" onClick={cancel} data-testid="backtest-cancel">
            Cancel
          </Button>
        )}
      </div>
      {run !== null && <Outcome run={run} names={names} stale={run.of !== table} />}
    </section>
  );
}

/** Names of the recordings that were kept; none where they cannot be looked at. */
function useKept(): string[] {
  const { data } = useAsked({ key: ["recordings"], ask: listRecordings });
  // Where there are none, the flight recorder's minutes are there all the same.
  return data?.recordings.filter(({ end }) => end !== null).map(({ name }) => name) ?? [];
}

function Outcome(props: { run: BacktestRun; names: ReadonlyMap<string, string>; stale: boolean }) {
  const { run, names, stale } = props;
  const { answer, error } = run;
  if (error !== null) {
    return <Problem error={error} testId="backtest-error" />;
  }
  if (answer === null || answer.state === "waiting" || answer.state === "running") {
    const share = Math.round((answer?.progress ?? 0) * 100);
    return (
      <div className={classes.progress} data-testid="backtest-progress">
        <Progress value={share} aria-label="Back-test" transitionDuration={120} />
        <span className={page.muted}>
          {share} % {answer?.text}
        </span>
      </div>
    );
  }
  if (answer.report === null) {
    return (
      <p className={page.problem} role="alert" data-testid="backtest-error">
        {answer.error ?? (answer.state === "canceled" ? "It was cancelled." : "It has failed.")}
      </p>
    );
  }
  const { report } = answer;
  return (
    <div className={classes.backtest} data-testid="backtest-report">
      {stale && (
        <p className={page.note}>The rules have changed since: this is of the ones before.</p>
      )}
      <p className={classes.tally}>
        <span>● {report.same} the same</span>
        <span>▲ {report.new} new</span>
        <span>○ {report.gone} no longer</span>
        <span className={page.muted}>
          {secondsText(Math.round(report.end - report.start))} in {report.seconds.toFixed(1)} s,{" "}
          {report.messages.toLocaleString()} messages
        </span>
      </p>
      {answer.text !== "" && (
        <p className={page.note} data-testid="backtest-remark">
          {sentence(answer.text)}
        </p>
      )}
      {report.missing_topics.length > 0 && (
        <p className={page.note}>
          Not recorded, so not judged: {report.missing_topics.join(", ")}. They are recorded from
          now on if you apply.
        </p>
      )}
      {report.warm_up > 0 && (
        <p className={page.muted}>
          In its first {secondsText(Math.round(report.warm_up))}, holds and cooldowns of before are
          not known.
        </p>
      )}
      <BacktestTimeline report={report} names={names} />
      {report.truncated && (
        <p className={page.muted}>More firings than are listed: look at a shorter stretch.</p>
      )}
    </div>
  );
}
