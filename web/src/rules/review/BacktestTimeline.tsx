import { ActionIcon } from "@mantine/core";
import { useElementSize } from "@mantine/hooks";
import { IconArrowLeft, IconArrowRight, IconZoomIn, IconZoomOut } from "@tabler/icons-react";
import { useEffect, useMemo, useState } from "react";
import type { BacktestFiring, BacktestReport } from "../../api/ruleTypes";
import { clockText } from "../model/words";
import { LeafNow } from "../parts/LeafNow";
import classes from "./Timeline.module.css";
import { atText, type Cluster, clusters, pan, ticks, type Window, zoom } from "./timeline";

const SHAPES: Record<BacktestFiring["verdict"], string> = { same: "●", new: "▲", gone: "○" };
const VERDICT_WORDS: Record<BacktestFiring["verdict"], string> = {
  same: "fired then, and would again",
  new: "would fire now, did not then",
  gone: "fired then, would not now",
};
/** A thumb is wider than a mark: marks nearer than this are told as one. */
const MARK_PX = 20;

interface Props {
  report: BacktestReport;
  names: ReadonlyMap<string, string>;
}

/** A lane for each rule over the recording; each mark opens to what its leaves were. */
export function BacktestTimeline({ report, names }: Props) {
  const whole = useMemo<Window>(
    () => ({ from: 0, to: Math.max(1, report.end - report.start) }),
    [report],
  );
  const [view, setView] = useState(whole);
  const [chosen, setChosen] = useState<Cluster | null>(null);
  const { ref, width } = useElementSize();
  useEffect(() => {
    setView(whole);
    setChosen(null);
  }, [whole]);

  const perPixel = (view.to - view.from) / Math.max(1, width);
  const lanes = report.tallies.filter((tally) => tally.recorded > 0 || tally.proposed > 0);
  const silent = report.tallies.filter((tally) => tally.recorded === 0 && tally.proposed === 0);
  const place = (at: number) => `${((at - view.from) / (view.to - view.from)) * 100}%`;
  const middle = (view.from + view.to) / 2;
  return (
    <div className={classes.timeline} data-testid="backtest-timeline">
      <div className={classes.tools}>
        <Tool
          label="Look closer"
          Icon={IconZoomIn}
          onClick={() => setView(zoom(view, whole, 0.5, middle))}
        />
        <Tool
          label="Look wider"
          Icon={IconZoomOut}
          onClick={() => setView(zoom(view, whole, 2, middle))}
        />
        <Tool
          label="Earlier"
          Icon={IconArrowLeft}
          onClick={() => setView(pan(view, whole, -0.5))}
        />
        <Tool label="Later" Icon={IconArrowRight} onClick={() => setView(pan(view, whole, 0.5))} />
        <span className={classes.range}>
          {clockText(report.start + view.from)} – {clockText(report.start + view.to)}
        </span>
      </div>
      {lanes.map((tally) => (
        <div key={tally.rule_id} className={classes.lane} data-testid={`lane-${tally.rule_id}`}>
          <div className={classes.name}>
            {names.get(tally.rule_id) ?? tally.rule_id}
            <span className={classes.count}>
              {tally.recorded} then, {tally.proposed} now
            </span>
          </div>
          <div className={classes.track}>
            {clusters(
              report.firings.filter((firing) => firing.rule_id === tally.rule_id),
              view,
              perPixel * MARK_PX,
            ).map((cluster) => (
              <button
                key={`${cluster.at} ${cluster.verdict}`}
                type="button"
                className={classes.mark}
                data-verdict={cluster.verdict}
                aria-pressed={chosen?.firings[0] === cluster.firings[0]}
                style={{ left: place(cluster.at) }}
                aria-label={`${atText(cluster.at)}: ${VERDICT_WORDS[cluster.verdict]}${
                  cluster.firings.length > 1 ? `, ${cluster.firings.length} times` : ""
                }`}
                onClick={() => setChosen(cluster)}
                onMouseEnter={() => setChosen(cluster)}
              >
                {SHAPES[cluster.verdict]}
                {cluster.firings.length > 1 && (
                  <span className={classes.many}>{cluster.firings.length}</span>
                )}
              </button>
            ))}
          </div>
        </div>
      ))}
      <div className={classes.axis} ref={ref} aria-hidden>
        {ticks(view, Math.max(2, Math.floor(width / 70))).map((at) => (
          <span key={at} style={{ left: place(at) }}>
            {atText(at)}
          </span>
        ))}
      </div>
      {chosen !== null && <Details cluster={chosen} />}
      {silent.length > 0 && (
        <details className={classes.silent}>
          <summary>{silent.length} without any firing</summary>
          <ul>
            {silent.map((tally) => (
              <li key={tally.rule_id}>
                {names.get(tally.rule_id) ?? tally.rule_id}
                {tally.text !== "" && `: ${tally.text}`}
              </li>
            ))}
          </ul>
        </details>
      )}
    </div>
  );
}

function Details({ cluster }: { cluster: Cluster }) {
  const firing = cluster.firings[0];
  if (firing === undefined) return null;
  return (
    <div className={classes.details} aria-live="polite" data-testid="backtest-details">
      <strong>
        {SHAPES[cluster.verdict]} {clockText(firing.time)}
        {cluster.firings.length > 1 && ` and ${cluster.firings.length - 1} more`}:{" "}
        {VERDICT_WORDS[cluster.verdict]}
      </strong>
      {firing.text !== "" && <p>{firing.text}</p>}
      {firing.assumed && <p>Rests on how long its actions are assumed to take.</p>}
      <ul>
        {firing.leaves.map((leaf) => (
          <li key={leaf.path.join(".")}>
            <span>{leaf.text}</span> <LeafNow reading={leaf} then />
          </li>
        ))}
      </ul>
    </div>
  );
}

function Tool(props: { label: string; Icon: typeof IconZoomIn; onClick: () => void }) {
  const { label, Icon, onClick } = props;
  return (
    <ActionIcon variant="default" size="lg" aria-label={label} title={label} onClick={onClick}>
      <Icon size={18} aria-hidden />
    </ActionIcon>
  );
}
