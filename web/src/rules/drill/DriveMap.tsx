import { useMemo } from "react";
import type { DrillPair } from "../../api/drillTypes";
import { arrow, Floor, MARGIN } from "./Floor";
import classes from "./Player.module.css";
import { type Mark, marksOnMap, Way } from "./playback";

const DEGREES = 180 / Math.PI;

interface Props {
  pair: DrillPair;
  time: number;
}

/** The world from above, x to the right and y up, with both robots where they were. */
export function DriveMap({ pair, time }: Props) {
  const { place } = pair;
  const ways = useMemo(
    () => ({ proposed: new Way(pair.proposed), in_force: new Way(pair.in_force) }),
    [pair],
  );
  const [left = 0, low = 0, right = 1, high = 1] = place.bounds;
  const width = right - left + 2 * MARGIN;
  const height = high - low + 2 * MARGIN;
  const unit = Math.max(width, height) / 44;
  return (
    <svg
      className={classes.map}
      viewBox={`${left - MARGIN} ${-high - MARGIN} ${width} ${height}`}
      role="img"
      aria-label={`${place.title}: the way under the proposed rules and under those in force`}
      data-testid="drive-map"
    >
      <Floor place={place} />
      {pair.proposed.goals.map(({ x, y, sent }) => (
        <g key={`${x} ${y} ${sent}`} className={classes.goal}>
          <circle cx={x} cy={-y} r={1.2 * unit} />
          <circle className={classes.dot} cx={x} cy={-y} r={0.4 * unit} />
        </g>
      ))}
      {(["in_force", "proposed"] as const).map((side) => (
        <g key={side} data-side={side} className={classes.side}>
          <polyline className={classes.ahead} points={line(ways[side].points)} />
          <polyline className={classes.driven} points={line(ways[side].upTo(time))} />
        </g>
      ))}
      {(["in_force", "proposed"] as const).map((side) => {
        const here = ways[side].at(time);
        return (
          here !== null && (
            <g
              key={side}
              className={classes.robot}
              data-side={side}
              data-testid={`robot-${side}`}
              transform={`translate(${here.x} ${-here.y}) rotate(${-here.heading * DEGREES})`}
            >
              <circle r={1.3 * unit} />
              <path d={arrow(unit)} />
            </g>
          )
        );
      })}
      {/* Above the robots: one that was stopped stands on what stopped it. */}
      {(["in_force", "proposed"] as const).map((side) => (
        <g key={side} data-side={side} className={classes.side}>
          {marksOnMap(pair[side], time, 1.9 * unit).map((mark) => (
            <MapMark key={`${mark.kind} ${mark.at} ${mark.text}`} mark={mark} r={0.9 * unit} />
          ))}
        </g>
      ))}
    </svg>
  );
}

function MapMark({ mark, r }: { mark: Mark; r: number }) {
  const shapes: Record<Mark["kind"], string> = {
    fault: `M 0 ${-r} L ${0.95 * r} ${0.75 * r} L ${-0.95 * r} ${0.75 * r} Z`,
    firing: `M 0 ${-r} L ${0.8 * r} 0 L 0 ${r} L ${-0.8 * r} 0 Z`,
    stop: `M ${-r} ${-r} H ${r} V ${r} H ${-r} Z`,
    contact: `M ${-r} ${-r} L ${r} ${r} M ${-r} ${r} L ${r} ${-r}`,
  };
  return (
    <path
      className={classes.mark}
      data-kind={mark.kind}
      d={shapes[mark.kind]}
      transform={`translate(${mark.x ?? 0} ${-(mark.y ?? 0)})`}
    >
      <title>{`${mark.at.toFixed(1)} s: ${mark.text}`}</title>
    </path>
  );
}

const line = (points: readonly { x: number; y: number }[]) =>
  points.map(({ x, y }) => `${x.toFixed(3)},${(-y).toFixed(3)}`).join(" ");
