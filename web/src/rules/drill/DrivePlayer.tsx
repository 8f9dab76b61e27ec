import { Button } from "@mantine/core";
import { IconPlayerPause, IconPlayerPlay } from "@tabler/icons-react";
import { useCallback, useEffect, useMemo, useState } from "react";
import { getDrillPair } from "../../api/drillsClient";
import type { DrillPair, Drive } from "../../api/drillTypes";
import { useAsked } from "../../api/queries";
import { Choice } from "../../ui/controls/Choice";
import { Problem } from "../../ui/Problem";
import page from "../../ui/page.module.css";
import { DriveMap } from "./DriveMap";
import { DriveTimeline } from "./DriveTimeline";
import classes from "./Player.module.css";
import { going, marksOf, played, SHAPES, SPEEDS } from "./playback";

/** The two tables, how they are called and which shape they have on the map. */
export const SIDES = [
  { side: "proposed", name: "Proposed", shape: "▶" },
  { side: "in_force", name: "In force", shape: "▷" },
] as const;

/** One scenario under both tables, to be watched. */
export function DrivePlayer({ drill, scenario }: { drill: string; scenario: string }) {
  const { data: pair, error } = useAsked({
    key: ["drive", drill, scenario],
    ask: (signal) => getDrillPair(drill, scenario, signal),
  });
  return (
    <div className={classes.player} data-testid="drive-player">
      <Problem error={error} />
      {pair !== null && <Player pair={pair} />}
    </div>
  );
}

function Player({ pair }: { pair: DrillPair }) {
  const end = Math.max(pair.proposed.duration, pair.in_force.duration);
  const [time, setTime] = useState(0);
  const [speed, setSpeed] = useState("5");
  const [playing, setPlaying] = useState(false);
  usePlaying(
    playing,
    Number(speed),
    useCallback((ms, rate) => setTime((was) => played(was, ms, rate, end)), [end]),
  );
  useEffect(() => {
    if (time >= end) setPlaying(false);
  }, [time, end]);
  const seek = (at: number) => {
    setPlaying(false);
    setTime(Math.min(end, Math.max(0, at)));
  };
  const toggle = () => {
    if (!playing && time >= end) setTime(0);
    setPlaying(!playing);
  };
  return (
    <>
      <DriveMap pair={pair} time={time} />
      <div className={classes.controls}>
        <Button
          variant="default"
          className={classes.play}
          aria-label={playing ? "Pause" : "Play"}
          data-testid="drive-play"
          onClick={toggle}
        >
          {playing ? (
            <IconPlayerPause size={20} aria-hidden />
          ) : (
            <IconPlayerPlay size={20} aria-hidden />
          )}
        </Button>
        <input
          type="range"
          className={classes.head}
          min={0}
          max={end}
          step={0.1}
          value={time}
          aria-label="Moment"
          aria-valuetext={`${time.toFixed(1)} s of ${end.toFixed(1)} s`}
          data-testid="drive-moment"
          onChange={(event) => seek(Number(event.currentTarget.value))}
        />
        <span className={classes.clock} data-testid="drive-clock">
          {time.toFixed(1)} s of {end.toFixed(1)} s
        </span>
        <Choice
          className={classes.speed}
          aria-label="Speed"
          data={SPEEDS.map((each) => ({ value: String(each), label: `${each}×` }))}
          value={speed}
          data-testid="drive-speed"
          onChange={setSpeed}
        />
      </div>
      {SIDES.map(({ side, name, shape }) => (
        <div key={side} data-testid={`side-${side}`}>
          <p className={classes.now}>
            <strong>
              <span className={classes.shape} data-side={side} aria-hidden>
                {shape}
              </span>{" "}
              {name}
            </strong>{" "}
            <span className={page.muted}>{going(pair[side], time)}</span>
          </p>
          <DriveTimeline drive={pair[side]} end={end} time={time} onSeek={seek} />
        </div>
      ))}
      <Happenings pair={pair} onSeek={seek} />
    </>
  );
}

/** Calls back before each picture while it plays. */
function usePlaying(playing: boolean, speed: number, tick: (ms: number, speed: number) => void) {
  useEffect(() => {
    if (!playing) return;
    let last = performance.now();
    let frame = requestAnimationFrame(function next(now) {
      tick(now - last, speed);
      last = now;
      frame = requestAnimationFrame(next);
    });
    return () => cancelAnimationFrame(frame);
  }, [playing, speed, tick]);
}

/** All that has a mark, in words, each of which leads to its moment. */
function Happenings({ pair, onSeek }: { pair: DrillPair; onSeek: (at: number) => void }) {
  const told = useMemo(
    () =>
      SIDES.flatMap(({ side, name }) =>
        marksOf(pair[side]).map((mark) => ({ ...mark, name })),
      ).sort((a, b) => a.at - b.at),
    [pair],
  );
  return (
    <details className={classes.happenings}>
      <summary>All that happened ({told.length})</summary>
      <ol>
        {told.map((mark) => (
          <li key={`${mark.at} ${mark.name} ${mark.kind} ${mark.text}`}>
            <button type="button" className={page.more} onClick={() => onSeek(mark.at)}>
              {mark.at.toFixed(1)} s {SHAPES[mark.kind]} {mark.name}: {mark.text}
            </button>
          </li>
        ))}
      </ol>
      <Why drive={pair.proposed} name="Proposed" />
      <Why drive={pair.in_force} name="In force" />
    </details>
  );
}

function Why({ drive, name }: { drive: Drive; name: string }) {
  return (
    <p>
      {name}: {drive.why}
    </p>
  );
}
