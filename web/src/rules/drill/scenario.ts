/** A scenario that a person makes up: where the robot starts, where to, and what breaks when. */
import type { DrillFault, DrillPlace, Scenario, ScheduledFault } from "../../api/drillTypes";

export interface Spot {
  x: number;
  y: number;
}
export interface Heading extends Spot {
  yaw: number;
}

export const DEGREES = 180 / Math.PI;
/** What takes goals and faults that a person lists; beyond it a file is the better tool. */
export const MOST_GOALS = 10;
export const MOST_FAULTS = 10;

/** Millimetres are enough, and can be read. */
const near = (value: number) => Math.round(value * 1000) / 1000;

/** A first scenario in a world: from where its robot starts, to where nobody has said yet. */
export const newScenario = (world: string, robot: string): Scenario => ({
  name: "my own",
  world,
  robot,
  seed: 1,
  start: null,
  goals: [],
  faults: [],
  operators: [],
  limit: 120,
});

export const startAt = (scenario: Scenario, { x, y, yaw }: Heading): Scenario => ({
  ...scenario,
  start: { x: near(x), y: near(y), yaw: near(yaw) },
});

/** A goal more, or another place for one that there is; each begins when the one before has ended. */
export function goalAt(scenario: Scenario, index: number, { x, y }: Spot): Scenario {
  const before = scenario.goals[index];
  const goal = {
    yaw: null,
    topic: null,
    tolerance: null,
    heading_tolerance: null,
    at: null,
    ...before,
    x: near(x),
    y: near(y),
  };
  return { ...scenario, goals: replaced(scenario.goals, index, goal) };
}

/** When a goal is sent; at 0 with all that begins. */
export function goalSentAt(scenario: Scenario, index: number, at: number): Scenario {
  const goals = scenario.goals.map((goal, place) => (place === index ? { ...goal, at } : goal));
  return { ...scenario, goals };
}

export const withoutGoal = (scenario: Scenario, index: number): Scenario => ({
  ...scenario,
  goals: scenario.goals.filter((_, place) => place !== index),
});

/** Something more that breaks, or another thing in the place of one that there is. */
export const faultAt = (scenario: Scenario, index: number, fault: ScheduledFault): Scenario => ({
  ...scenario,
  faults: replaced(scenario.faults, index, fault),
});

export const withoutFault = (scenario: Scenario, index: number): Scenario => ({
  ...scenario,
  faults: scenario.faults.filter((_, place) => place !== index),
});

/** A fault of another kind, at the time of the one before: what it needs is filled in. */
export function ofKind(
  before: ScheduledFault,
  kind: DrillFault,
  components: readonly string[],
): ScheduledFault {
  const parameter = kind.parameter === "NAME" ? (components[0] ?? kind.example) : kind.example;
  const name = kind.parameter === "" ? kind.name : `${kind.name}:${parameter}`;
  return { name, at: before.at, duration: kind.at_once ? 0 : before.duration || 10 };
}

/** What is missing before it can be driven; empty when nothing is. */
export function missing({ goals }: Scenario): string {
  return goals.length === 0 ? "Say where the robot is to go: press on the map." : "";
}

/** What the console has against a scenario, with its parts named as they stand on the page. */
export const inWords = (title: string): string =>
  title.replace(
    /\bscenario\.(?:goals|faults)\.(\d+)(?:\.(\w+))?/g,
    (path: string, index: string, field: string | undefined) =>
      `${path.startsWith("scenario.goals") ? "goal" : "fault"} ${Number(index) + 1}` +
      (field === undefined ? "" : `, ${field.replaceAll("_", " ")}`),
  );

/** What is wrong with the goals in this world, in a sentence; empty when nothing is. */
export function outOfPlace({ goals }: Scenario, place: DrillPlace): string {
  const wrong = goals.flatMap((goal, index) => (standsIn(place, goal) ? [] : [index + 1]));
  if (wrong.length === 0) return "";
  const which = wrong.length === 1 ? `Goal ${wrong[0]} lies` : `Goals ${wrong.join(", ")} lie`;
  return `${which} off the floor or inside something solid: the robot will refuse it.`;
}

/** Whether a point is on the floor, and in nothing that is solid. */
function standsIn({ floor, walls }: DrillPlace, { x, y }: Spot): boolean {
  let inside = false;
  floor.forEach(([ax = 0, ay = 0], index) => {
    const [bx = 0, by = 0] = floor[(index + 1) % floor.length] ?? [];
    if (ay > y !== by > y && x < ax + ((y - ay) / (by - ay)) * (bx - ax)) inside = !inside;
  });
  return (
    inside &&
    !walls.some((wall) => {
      const [dx, dy] = [x - wall.x, y - wall.y];
      if (wall.round) return Math.hypot(dx, dy) < wall.length / 2;
      const [cos, sin] = [Math.cos(wall.yaw), Math.sin(wall.yaw)];
      const [ahead, left] = [cos * dx + sin * dy, cos * dy - sin * dx];
      return Math.abs(ahead) < wall.length / 2 && Math.abs(left) < wall.width / 2;
    })
  );
}

/** In another world there is none of the places of this one. */
export const inWorld = (scenario: Scenario, world: string): Scenario =>
  world === scenario.world
    ? scenario
    : { ...scenario, world, start: null, goals: [], faults: scenario.faults };

function replaced<T>(items: readonly T[], index: number, item: T): T[] {
  return index < items.length
    ? items.map((each, place) => (place === index ? item : each))
    : [...items, item];
}
