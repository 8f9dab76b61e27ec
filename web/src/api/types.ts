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
export type Control = State["control"];
export type Goal = NonNullable<State["goal"]>;
export type GoalCheck = Sent<Schemas["GoalCheck"]>;

/** Where a goal was pressed and released, as fractions of the scene (u right, v down). */
export type GoalPick = Schemas["GestureCheck"];

/** A further topic that can be drawn. */
export type Extra = State["extras"][number];
export type CameraNews = Sent<Schemas["CameraNews"]>;
export type FlatExtra = Sent<Schemas["FlatExtra"]>;

/** What has changed on a flat map: what is left out is as it was. */
export type FlatNews = Partial<Schemas["FlatNews"]>;

/** A goal in the map frame: metres, and radians counter-clockwise from +x. */
export type GoalPoint = Schemas["GoalRequest"];

/** A named place to go to, as it was looked at. */
export type PlaceGoal = Schemas["PlaceGoal"];
export type PlaceList = Sent<Schemas["PlaceList"]>;
export type Place = PlaceList["places"][number];
export type PlaceSave = Schemas["PlaceSave"];
export type PlaceEdit = Schemas["PlaceEdit"];

export type ZoneList = Sent<Schemas["ZoneList"]>;
export type Zone = ZoneList["zones"][number];
export type Mask = ZoneList["masks"][number];
export type ZoneSave = Schemas["ZoneSave"];
export type ZoneSketch = Schemas["ZoneSketch"];

export type LogPage = Sent<Schemas["LogPage"]>;
export type LogLine = LogPage["lines"][number];
export type LogLevel = LogLine["level"];

export type MissionList = Sent<Schemas["MissionList"]>;
export type Mission = MissionList["missions"][number];
export type MissionSave = Schemas["MissionSave"];
export type Waypoint = Schemas["Waypoint"];
export type MissionTask = NonNullable<Waypoint["tasks"]>[number];
export type Missions = State["missions"];
export type MissionRun = NonNullable<Missions["run"]>;
export type RunVerb = "pause" | "resume" | "skip" | "confirm" | "cancel";

/** How well scan and map agree, as the robot thinks. */
export type Localisation = State["localisation"];
export type LocateCheck = Sent<Schemas["LocateCheck"]>;
export type LocateFit = NonNullable<LocateCheck["here"]>;

/** Where a person pressed and released to say where the robot is, as of a goal. */
export type LocatePick = Schemas["LocateGesture"];

/** The same in the map frame. */
export type LocatePoint = Schemas["LocateRequest"];

/** Where the robot is to believe that it is. */
export type RobotPose = Schemas["RobotPose"];

/** Points that are measured between. */
export type MeasureSketch = Schemas["MeasureSketch"];

/** What is said on the socket of the hand. */
export type HandRequest = Sent<Schemas["HandRequest"]>;
export type HandAnswer = Sent<Schemas["HandAnswer"]>;

export type TimelinePage = Sent<Schemas["TimelinePage"]>;
export type TimelineEntry = TimelinePage["entries"][number];
export type TimelineSlot = TimelinePage["slots"][number];
export type TimelineKind = TimelineEntry["kind"];
export type TimelineLevel = TimelineEntry["level"];
export type NoteSave = Schemas["NoteSave"];

export type AuditLog = Sent<Schemas["AuditPage"]>;
export type AuditLine = AuditLog["lines"][number];

/** What the state socket sends. */
export type ServerMessage = Sent<Schemas["Hello"]> | Sent<Schemas["Pong"]> | State;
