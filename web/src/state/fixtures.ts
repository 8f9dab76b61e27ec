import type { Component, Drive, State, Stream } from "../api/types";

// What tests begin with: a robot with nothing wrong. Each says only what is different.

export const component = (
  name: string,
  label: string,
  part: Partial<Component> = {},
): Component => ({
  name,
  label,
  status: "healthy",
  message: "Running - Healthy",
  sources: [],
  src_topics: [],
  src_components: [],
  src_algorithms: [],
  process: null,
  inputs: [],
  outputs: [],
  age: 0.1,
  topic: `/${name}/status`,
  ...part,
});

export const stream = (
  key: Stream["key"],
  label: string,
  topic: string,
  part: Partial<Stream> = {},
): Stream => ({ key, label, topic, age: 0.1, deadline: 1, stale: false, rate: 10, ...part });

export const DRIVE: Drive = {
  available: true,
  driven_by: "",
  stopped: false,
  standstill: true,
  stopped_by: "",
  reason: "",
  limited_by: "",
  speed_factor: 1,
  age: 0,
};

export const robot = (part: Partial<State> = {}): State => ({
  type: "state",
  seq: 1,
  time: 0,
  robot: { name: "robot", radius: 0.1, problem: "" },
  pose: { x: 0, y: 0, yaw: 0, v: 0, w: 0, age: 0 },
  localisation: { agreement: 0.97, lost: false, problem: null, age: 0.1 },
  streams: [stream("scan", "Laser scan", "/scan")],
  components: [component("planner", "Planner")],
  drive: null,
  goal: null,
  simulation: null,
  battery: null,
  places: { available: false, revision: 0, map: null },
  zones: { available: false, revision: 0, masks: 0 },
  timeline: { available: false, newest: 0, changes: 0 },
  log: { available: false, newest: 0, newest_warning: 0 },
  extras: [],
  cameras: [],
  missions: { available: false, revision: 0, notice: "", run: null, queue: [] },
  control: {
    holder: "",
    holder_key: "",
    asked_by: "",
    asked_key: "",
    asked: 0,
    taken_from: "",
    taken_key: "",
    reason: "",
  },
  rules: {
    available: false,
    revision: 0,
    confirmed: 0,
    probation_left: 0,
    notice: "",
    alarms: 0,
    age: null,
  },
  processes: [],
  ros: { domain_id: 0, middleware: "" },
  viewers: 1,
  audit_problem: "",
  webhook_problem: "",
  ...part,
});
