/** The parts of the generated schema that speak of drills, under the names the page uses. */
import type { components } from "../../generated/schema";
import type { Sent } from "./http";

type Schemas = components["schemas"];

export type Scenario = Sent<Schemas["Scenario"]>;
export type ScheduledFault = Scenario["faults"][number];
export type RecordedScenario = Sent<Schemas["RecordedScenario"]>;
export type DrillRoom = Sent<Schemas["DrillRoom"]>;
export type Drill = Sent<Schemas["DrillProgress"]>;
export type DrillSummary = Sent<Schemas["DrillSummary"]>;
export type DrillFault = DrillRoom["faults"][number];
export type DrillDrive = DrillSummary["drives"][number];
export type DrillPair = Sent<Schemas["DrillPair"]>;
export type DrillPlace = Sent<Schemas["DrillPlace"]>;
export type Drive = Sent<Schemas["DriveResult"]>;
export type Moment = Drive["moments"][number];
