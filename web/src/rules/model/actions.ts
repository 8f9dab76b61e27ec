/** What a rule can do: the choices on this robot, and each as a line of text. */
import type { Action, Graph, GraphComponent } from "../../api/ruleTypes";

type Values = Record<string, unknown>;

/** One line for an action, worded as the robot words it. */
export function actionText(action: Action): string {
  switch (action.kind) {
    case "log":
      return `log "${action.text}"`;
    case "method":
      return `${action.component}: ${words(action.method)}${argumentsText(action.kwargs)}`;
    case "lifecycle":
      return `${action.action} ${action.component}`;
    case "reconfigure":
      return `reconfigure ${action.component}`;
    case "update_parameters":
      return `set ${Object.entries(action.parameters)
        .map(([name, value]) => `${action.component}.${name} = ${valueText(value)}`)
        .join(", ")}`;
    case "publish":
      return `publish on /${action.topic}`;
    case "call_service":
      return `call /${action.service}`;
    case "send_goal":
      return `send goal to /${action.action}`;
    case "cancel_goal":
      return `cancel goals of /${action.action}`;
    case "raise_alarm":
      return `raise alarm "${action.alarm}"`;
    case "clear_alarm":
      return `clear alarm "${action.alarm}"`;
    case "start_mission":
      return `start mission "${action.mission}"`;
    case "python":
      return `run ${action.name} of the recipe`;
  }
}

const words = (name: string) => name.replaceAll("_", " ");

function argumentsText(values: Values | undefined): string {
  const entries = Object.entries(values ?? {});
  if (entries.length === 0) return "";
  return ` (${entries.map(([name, value]) => `${name} = ${valueText(value)}`).join(", ")})`;
}

export function valueText(value: unknown): string {
  if (value === undefined || value === null) return "none";
  if (typeof value === "string") return value.startsWith("$") ? value : `"${value}"`;
  const text = JSON.stringify(value);
  return text.length > 60 ? `${text.slice(0, 59)}…` : text;
}

/** One thing that can be chosen as an action. `key` tells it from all others. */
export interface ActionChoice {
  key: string;
  group: string;
  label: string;
  make: () => Action;
}

const COMMON = { timeout: 10, on_error: "abort" } as const;

/** The choices as a list to choose from shows them. */
export const grouped = (choices: readonly ActionChoice[]) =>
  [...new Set(choices.map((choice) => choice.group))].map((group) => ({
    group,
    items: choices
      .filter((choice) => choice.group === group)
      .map((choice) => ({ value: choice.key, label: choice.label })),
  }));

/** Methods that have an action of their own kind, or are of no use in a rule. */
const OTHERWISE = new Set([
  "start",
  "stop",
  "restart",
  "reconfigure",
  "set_param",
  "set_params",
  "broadcast_status",
]);
const STOP_ROBOT = "kompass_interfaces/srv/StopRobot";

const offered = (component: GraphComponent) =>
  component.methods.filter((method) => !OTHERWISE.has(method.name));

/**
 * What a rule of this person can do on this robot: the everyday things first, and nothing that the
 * guard rails would refuse.
 */
export function actionChoices(graph: Graph | null, who: "edited" | "engineer"): ActionChoice[] {
  const refused = new Set(graph?.refused?.[who] ?? []);
  return allChoices(graph).filter(({ key }) => !refused.has(key));
}

function allChoices(graph: Graph | null): ActionChoice[] {
  const general: ActionChoice[] = [
    choice("raise_alarm", "General", "Raise an alarm", () => ({
      ...COMMON,
      kind: "raise_alarm",
      alarm: "",
      text: "",
    })),
    choice("log", "General", "Write a line to the log", () => ({
      ...COMMON,
      kind: "log",
      text: "",
      level: "warning",
    })),
    choice("start_mission", "General", "Start a mission", () => ({
      ...COMMON,
      kind: "start_mission",
      mission: "",
    })),
    choice("clear_alarm", "General", "Clear an alarm", () => ({
      ...COMMON,
      kind: "clear_alarm",
      alarm: "",
      text: "",
    })),
  ];
  if (graph === null) return general;
  const components = graph.components.flatMap((component): ActionChoice[] => {
    const group = title(component.name);
    const name = component.name;
    return [
      ...offered(component).map((method) =>
        choice(`method:${name}:${method.name}`, group, `${group}: ${words(method.name)}`, () => ({
          ...COMMON,
          kind: "method",
          component: name,
          method: method.name,
          kwargs: {},
        })),
      ),
      ...(component.parameters.length === 0
        ? []
        : [
            choice(`update_parameters:${name}`, group, `${group}: set parameters`, () => ({
              ...COMMON,
              kind: "update_parameters",
              component: name,
              parameters: {},
              keep_alive: true,
            })),
          ]),
      ...(["restart", "stop", "start", "configure"] as const).map((what) =>
        choice(
          `lifecycle:${name}:${what}`,
          group,
          `${group}: ${what} the component`,
          (): Action => ({ ...COMMON, kind: "lifecycle", component: name, action: what }),
        ),
      ),
      choice(`reconfigure:${name}`, group, `${group}: reconfigure`, () => ({
        ...COMMON,
        kind: "reconfigure",
        component: name,
        config: {},
        keep_alive: false,
      })),
    ];
  });
  const goals = graph.actions.flatMap((server): ActionChoice[] => [
    choice(
      `send_goal:${bare(server.name)}`,
      "Goals",
      `Send a goal to ${slashed(server.name)}`,
      () => ({
        ...COMMON,
        timeout: null,
        kind: "send_goal",
        action: bare(server.name),
        type: server.type,
        goal: {},
      }),
    ),
    choice(
      `cancel_goal:${bare(server.name)}`,
      "Goals",
      `Cancel the goals of ${slashed(server.name)}`,
      () => ({
        ...COMMON,
        kind: "cancel_goal",
        action: bare(server.name),
      }),
    ),
  ]);
  const stop = graph.services
    .filter((service) => service.type === STOP_ROBOT)
    .slice(0, 1)
    .map((service) =>
      choice(
        `call_service:${bare(service.name)}`,
        "General",
        "Stop the robot",
        (): Action => ({
          ...COMMON,
          kind: "call_service",
          service: bare(service.name),
          type: service.type,
          // The monitor says which rule it is.
          request: { reason: "" },
        }),
      ),
    );
  const others = graph.services.filter(
    (service) => !stop.some(({ key }) => key === `call_service:${bare(service.name)}`),
  );
  const services = others.map((service) =>
    choice(
      `call_service:${bare(service.name)}`,
      "Services",
      `Call ${slashed(service.name)}`,
      () => ({
        ...COMMON,
        kind: "call_service",
        service: bare(service.name),
        type: service.type,
        request: {},
      }),
    ),
  );
  const topics = graph.topics.map((topic) =>
    choice(`publish:${bare(topic.name)}`, "Messages", `Publish on ${slashed(topic.name)}`, () => ({
      ...COMMON,
      kind: "publish",
      topic: bare(topic.name),
      type: topic.type,
      message: {},
      rate: null,
      period: null,
    })),
  );
  const functions = graph.functions.map((name) =>
    choice(`python:${name}`, "Functions of the recipe", `Run ${name}`, () => ({
      ...COMMON,
      kind: "python",
      name,
      kwargs: {},
    })),
  );
  return [...stop, ...general, ...functions, ...components, ...goals, ...services, ...topics];
}

function choice(key: string, group: string, label: string, make: () => Action): ActionChoice {
  return { key, group, label, make };
}

/** Which choice an action is, whether or not the robot offers it now. */
export function choiceKey(action: Action): string {
  switch (action.kind) {
    case "method":
      return `method:${action.component}:${action.method}`;
    case "lifecycle":
      return `lifecycle:${action.component}:${action.action}`;
    case "reconfigure":
    case "update_parameters":
      return `${action.kind}:${action.component}`;
    case "publish":
      return `publish:${action.topic}`;
    case "call_service":
      return `call_service:${action.service}`;
    case "send_goal":
    case "cancel_goal":
      return `${action.kind}:${action.action}`;
    case "python":
      return `python:${action.name}`;
    default:
      return action.kind;
  }
}

/** Both spellings are one topic; rules keep the one without the slash. */
export const bare = (name: string): string => name.replace(/^\/+/, "");

export const slashed = (name: string): string => (name.startsWith("/") ? name : `/${name}`);

/** `drive_manager` as one would head a list with it. */
export function title(name: string): string {
  const spaced = words(name);
  return spaced.charAt(0).toUpperCase() + spaced.slice(1);
}
