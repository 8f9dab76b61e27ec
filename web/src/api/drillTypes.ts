/** The parts of the generated schema that speak of drills, under the names the page uses. */
import type { components } from "../../generated/schema";
import type { Sent } from "./http";

type Schemas = components["schemas"];

export type DrillRoom = Sent<Schemas["DrillRoom"]>;
export type Drill = Sent<Schemas["DrillProgress"]>;
export type DrillSummary = Sent<Schemas["DrillSummary"]>;
export type DrillDrive = DrillSummary["drives"][number];
export type DrillPair = Sent<Schemas["DrillPair"]>;
export type DrillPlace = DrillPair["place"];
export type Drive = Sent<Schemas["DriveResult"]>;
export type Moment = Drive["moments"][number];
