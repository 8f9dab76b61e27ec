import { useMemo } from "react";
import type { Drive } from "../../api/drillTypes";
import classes from "./Player.module.css";
import { lanes, SHAPES } from "./playback";

interface Props {
  drive: Drive;
  /** Seconds that fill the width. */
  end: number;
  time: number;
  onSeek: (at: number) => void;
}

/** What was when under one table, with the play head; a press takes the head there. */
export function DriveTimeline({ drive, end, time, onSeek }: Props) {
  const rows = useMemo(() => lanes(drive), [drive]);
  const share = (at: number) => `${(100 * at) / Math.max(end, 0.001)}%`;
  const seek = (event: React.PointerEvent<HTMLDivElement>) => {
    const box = event.currentTarget.getBoundingClientRect();
    onSeek(((event.clientX - box.left) / Math.max(1, box.width)) * end);
  };
  return (
    <div className={classes.timeline}>
      <div className={classes.names} aria-hidden>
        {rows.map(({ name }) => (
          <span key={name}>{name}</span>
        ))}
      </div>
      {/* The range above does the same for the keyboard. */}
      <div
        className={classes.lanes}
        onPointerDown={(event) => {
          event.currentTarget.setPointerCapture(event.pointerId);
          seek(event);
        }}
        onPointerMove={(event) => {
          if (event.buttons > 0) seek(event);
        }}
      >
        {rows.map(({ name, stretches, marks }) => (
          <div key={name} className={classes.lane} data-lane={name}>
            {stretches.map(({ from, to, text }) => (
              <i
                key={`${from} ${text}`}
                className={classes.bar}
                title={`${from.toFixed(1)} s to ${to.toFixed(1)} s: ${text}`}
                style={{ left: share(from), width: share(to - from) }}
              />
            ))}
            {marks.map(({ at, kind, text }) => (
              <b
                key={`${at} ${kind} ${text}`}
                className={classes.point}
                data-kind={kind}
                title={`${at.toFixed(1)} s: ${text}`}
                style={{ left: share(at) }}
              >
                {SHAPES[kind]}
              </b>
            ))}
          </div>
        ))}
        {drive.duration < end - 0.1 && (
          <span
            className={classes.over}
            title={`This drive ended after ${drive.duration.toFixed(1)} s`}
            style={{ left: share(drive.duration) }}
          />
        )}
        <span className={classes.needle} style={{ left: share(time) }} aria-hidden />
      </div>
    </div>
  );
}
