import type { DrillPlace } from "../../api/drillTypes";
import classes from "./Player.module.css";

/** Beside the walls of a world, m. */
export const MARGIN = 0.15;
const DEGREES = 180 / Math.PI;

/** The front of a robot that is drawn with this unit of length. */
export const arrow = (unit: number) =>
  `M ${unit} 0 L ${-0.6 * unit} ${0.7 * unit} L ${-0.6 * unit} ${-0.7 * unit} Z`;

/** What a world has: its floor, and all that is solid. */
export function Floor({ place }: { place: DrillPlace }) {
  return (
    <>
      <polygon
        className={classes.floor}
        points={place.floor.map(([x = 0, y = 0]) => `${x},${-y}`).join(" ")}
      />
      {place.walls.map((wall) =>
        wall.round ? (
          <circle
            key={`${wall.x} ${wall.y}`}
            className={classes.wall}
            cx={wall.x}
            cy={-wall.y}
            r={wall.length / 2}
          />
        ) : (
          <rect
            key={`${wall.x} ${wall.y}`}
            className={classes.wall}
            x={-wall.length / 2}
            y={-wall.width / 2}
            width={wall.length}
            height={wall.width}
            transform={`translate(${wall.x} ${-wall.y}) rotate(${-wall.yaw * DEGREES})`}
          />
        ),
      )}
    </>
  );
}
