/** The parts of the generated schema that speak of rules, under the names the page uses. */
import type { components } from "../../generated/schema";
import type { Sent } from "./http";

type Schemas = components["schemas"];

export type Table = Sent<Schemas["Table"]>;
export type Rule = Sent<Schemas["Rule"]>;
export type RuleEvent = Rule["event"];
export type Trigger = RuleEvent["trigger"];
export type Mode = RuleEvent["mode"];
export type Condition = RuleEvent["condition"];
export type ConditionKind = Condition["kind"];
export type Group = Extract<Condition, { kind: "all" | "any" }>;
export type Leaf = Exclude<Condition, { kind: "all" | "any" | "not" }>;
export type Compare = Extract<Condition, { kind: "compare" }>;
export type Operator = Compare["operator"];
export type Literal = Compare["value"];
export type Signal = Sent<Schemas["Signal"]>;
export type Aggregate = NonNullable<Signal["aggregate"]>;
export type Action = Rule["actions"][number];

export type TableView = Sent<Schemas["TableView"]>;
export type Finding = Sent<Schemas["Finding"]>;
export type CheckReport = Sent<Schemas["CheckReport"]>;
export type Prospect = CheckReport["prospects"][number];
export type ApplyReport = Sent<Schemas["ApplyReport"]>;
export type Effect = CheckReport["effect"];
export type TableDiff = CheckReport["diff"];
export type RuleChange = TableDiff["changes"][number];
export type FieldChange = RuleChange["fields"][number];
export type Conflict = Sent<Schemas["Conflict"]>;
export type History = Sent<Schemas["History"]>;
export type Revision = History["revisions"][number];
export type RuleStatus = Sent<Schemas["RuleStatus"]>;
export type LeafReading = Sent<Schemas["LeafReading"]>;
export type Explanation = Sent<Schemas["ExplanationView"]>;
type Journal = Sent<Schemas["Journal"]>;
export type Firing = Journal["firings"][number];
/** `problem` is why it failed, and no more; a robot that does not tell it leaves it out. */
export type ActionRecord = Firing["actions"][number] & { problem?: string };
export type Graph = Sent<Schemas["GraphView"]>;
export type GraphTopic = Graph["topics"][number];
export type GraphField = Sent<Schemas["FieldView"]>;
export type GraphComponent = Graph["components"][number];
export type Backtest = Sent<Schemas["BacktestProgress"]>;
export type BacktestReport = Sent<Schemas["BacktestReport"]>;
export type BacktestFiring = BacktestReport["firings"][number];
export type RulesLive = Sent<Schemas["RulesLive"]>;
export type Alarm = RulesLive["alarms"][number];
export type ProbeReading = Sent<Schemas["ProbeReading"]>;
type RecordingList = Sent<Schemas["RecordingList"]>;
export type Recording = RecordingList["recordings"][number];

/** Where a node is in the tree of a condition: child indices from its root. */
export type TreePath = readonly number[];
