/** The parts of the generated schema that the page uses, under the names it uses. */
import type { components } from "./schema";

type Schemas = components["schemas"];

export type Session = Schemas["Session"];
export type View = Schemas["View"];
export type ViewPatch = Schemas["ViewPatch"];
export type LayerKey = keyof View["layers"];
export type State = Schemas["State"];
export type Pose = NonNullable<State["pose"]>;
export type Stream = State["streams"][number];
export type Component = State["components"][number];
export type Drive = NonNullable<State["drive"]>;
export type Goal = NonNullable<State["goal"]>;
export type GoalCheck = Schemas["GoalCheck"];
export type GoalSent = Schemas["GoalSent"];
export type StopAnswer = Schemas["StopAnswer"];

/** Where a goal was pressed and released, as fractions of the scene (u right, v down). */
export interface GoalPick {
  view: string;
  start: [number, number];
  end: [number, number] | null;
}

/** A goal in the map frame: metres, and radians counter-clockwise from +x. */
export interface GoalPoint {
  x: number;
  y: number;
  yaw: number | null;
  view?: string;
}

/** What the state socket sends. */
export type ServerMessage = Schemas["Hello"] | Schemas["Pong"] | State;
