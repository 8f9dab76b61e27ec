import type { DrillPlace, Scenario } from "../../api/drillTypes";
import { arrow, Floor, MARGIN } from "./Floor";
import classes from "./Player.module.css";
import { DEGREES, type Spot } from "./scenario";

interface Props {
  place: DrillPlace;
  scenario: Scenario;
  locked: boolean;
  onPress: (spot: Spot) => void;
}

/** The world from above: a press is a place, of the start or of a goal. */
export function ScenarioMap({ place, scenario, locked, onPress }: Props) {
  const [left = 0, low = 0, right = 1, high = 1] = place.bounds;
  const width = right - left + 2 * MARGIN;
  const height = high - low + 2 * MARGIN;
  const unit = Math.max(width, height) / 44;
  const [x = 0, y = 0, yaw = 0] = place.start;
  const start = scenario.start ?? { x, y, yaw };
  return (
    // Fields beside it say the same in figures, for who has no pointer.
    // biome-ignore lint/a11y/useKeyWithClickEvents: see above
    <svg
      className={classes.map}
      data-pressed={!locked || undefined}
      viewBox={`${left - MARGIN} ${-high - MARGIN} ${width} ${height}`}
      role="img"
      aria-label={`${place.title} from above, with the start and ${scenario.goals.length} goals`}
      data-testid="scenario-map"
      onClick={(event) => {
        const matrix = event.currentTarget.getScreenCTM();
        if (locked || matrix === null) return;
        const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
        onPress({ x: point.x, y: -point.y });
      }}
    >
      <Floor place={place} />
      {scenario.goals.map((goal, index) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: a goal is known by its place in the list
        <g key={index} className={classes.goal} data-testid={`scenario-goal-${index}`}>
          <circle cx={goal.x} cy={-goal.y} r={1.2 * unit} />
          <circle className={classes.dot} cx={goal.x} cy={-goal.y} r={0.4 * unit} />
        </g>
      ))}
      <g
        className={classes.robot}
        data-side="proposed"
        data-testid="scenario-start"
        transform={`translate(${start.x} ${-start.y}) rotate(${-start.yaw * DEGREES})`}
      >
        <circle r={1.3 * unit} />
        <path d={arrow(unit)} />
      </g>
    </svg>
  );
}
