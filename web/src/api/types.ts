/** The parts of the generated schema that the page uses, under the names it uses. */
import type { components } from "../../generated/schema";
import type { Sent } from "./http";

type Schemas = components["schemas"];

export type Session = Sent<Schemas["SessionInfo"]>;
export type View = Sent<Schemas["View"]>;
export type ViewPatch = Schemas["ViewPatch"];
export type PlayedDrive = Sent<Schemas["PlayedDrive"]>;
export type LayerKey = keyof View["layers"];
export type State = Sent<Schemas["State"]>;
export type Pose = NonNullable<State["pose"]>;
export type Stream = State["streams"][number];
export type Component = State["components"][number];
export type Drive = NonNullable<State["drive"]>;
export type Goal = NonNullable<State["goal"]>;
export type GoalCheck = Sent<Schemas["GoalCheck"]>;

/** Where a goal was pressed and released, as fractions of the scene (u right, v down). */
export type GoalPick = Schemas["GestureCheck"];

/** A goal in the map frame: metres, and radians counter-clockwise from +x. */
export type GoalPoint = Schemas["GoalRequest"];

/** What is said on the socket of the hand. */
export type HandRequest = Sent<Schemas["HandRequest"]>;
export type HandAnswer = Sent<Schemas["HandAnswer"]>;

export type AuditLog = Sent<Schemas["AuditPage"]>;
export type AuditLine = AuditLog["lines"][number];

/** What the state socket sends. */
export type ServerMessage = Sent<Schemas["Hello"]> | Sent<Schemas["Pong"]> | State;
