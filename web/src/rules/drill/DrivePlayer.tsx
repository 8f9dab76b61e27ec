import { Button } from "@mantine/core";
import { IconPlayerPause, IconPlayerPlay } from "@tabler/icons-react";
import { useCallback, useEffect, useMemo, useState } from "react";
import { getDrillPair } from "../../api/drillsClient";
import type { DrillPair, Drive } from "../../api/drillTypes";
import { useAsked } from "../../api/queries";
import { useStage } from "../../scene/StageContext";
import { SIDES } from "../../scene/sides";
import { Choice } from "../../ui/controls/Choice";
import { Problem } from "../../ui/Problem";
import page from "../../ui/page.module.css";
import { DriveMap } from "./DriveMap";
import { DriveTimeline } from "./DriveTimeline";
import classes from "./Player.module.css";
import { going, marksOf, played, SHAPES, SPEEDS, whyText } from "./playback";

/** One scenario under both tables, to be watched. */
export function DrivePlayer({ drill, scenario }: { drill: string; scenario: string }) {
  const { data: pair, error } = useAsked({
    key: ["drive", drill, scenario],
    ask: (signal) => getDrillPair(drill, scenario, signal),
  });
  return (
    <div className={classes.player} data-testid="drive-player">
      <Problem error={error} />
      {pair !== null && <Player drill={drill} pair={pair} />}
    </div>
  );
}

function Player({ drill, pair }: { drill: string; pair: DrillPair }) {
  const end = Math.max(pair.proposed.duration, pair.in_force.duration);
  const [time, setTime] = useState(0);
  const [speed, setSpeed] = useState("5");
  const [playing, setPlaying] = useState(false);
  const { inScene, tell } = useScenePlayer(drill, pair.proposed.scenario.name, setPlaying);
  usePlaying(
    playing,
    Number(speed),
    useCallback((ms, rate) => setTime((was) => played(was, ms, rate, end)), [end]),
  );
  useEffect(() => {
    if (time >= end) setPlaying(false);
  }, [time, end]);
  const seek = (at: number) => {
    const moment = Math.min(end, Math.max(0, at));
    setPlaying(false);
    setTime(moment);
    tell(moment, 0);
  };
  const toggle = () => {
    const from = !playing && time >= end ? 0 : time;
    setTime(from);
    setPlaying(!playing);
    tell(from, playing ? 0 : Number(speed));
  };
  const hurry = (next: string) => {
    setSpeed(next);
    if (playing) tell(time, Number(next));
  };
  return (
    <>
      {inScene ? (
        <p className={page.muted}>Both robots drive in the scene, in the place of yours.</p>
      ) : (
        <DriveMap pair={pair} time={time} />
      )}
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
          max={Math.ceil(10 * end) / 10}
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
          onChange={hurry}
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

/**
 * Plays in the scene what the player does, where there is one to play in. Whoever goes back to the
 * robot stops it; whoever leaves the player goes back to the robot.
 */
function useScenePlayer(drill: string, scenario: string, setPlaying: (playing: boolean) => void) {
  const { ready, error, shown, show, leave } = useStage();
  const inScene = ready && error === null;
  const on = shown?.drill === drill && shown.scenario === scenario;
  useEffect(() => {
    if (inScene && !on) setPlaying(false);
  }, [inScene, on, setPlaying]);
  useEffect(() => leave, [leave]);
  const tell = (moment: number, speed: number) => show({ drill, scenario, moment, speed });
  return { inScene, tell };
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
      {name}: {whyText(drive)}
    </p>
  );
}
