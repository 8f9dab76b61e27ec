import { expect, test } from "vitest";
import type { Graph } from "../../api/ruleTypes";
import { actionChoices } from "./actions";

const topic = (name: string, type: string) => ({
  name,
  type,
  latched: false,
  publishers: 1,
  component: "",
  rate: null,
  silent: null,
});
const graph: Graph = {
  topics: [topic("cmd_vel", "geometry_msgs/msg/Twist"), topic("lamp", "std_msgs/msg/Bool")],
  types: {},
  components: [{ name: "controller", kind: "Controller", methods: [], parameters: [] }],
  services: [
    { name: "drive_manager/stop", type: "kompass_interfaces/srv/StopRobot" },
    { name: "drive_manager/release_stop", type: "kompass_interfaces/srv/ReleaseStop" },
  ],
  actions: [],
  functions: [],
  refused: {
    edited: ["publish:cmd_vel", "publish:lamp", "call_service:drive_manager/release_stop"],
    engineer: ["publish:cmd_vel", "call_service:drive_manager/release_stop"],
  },
};
const keys = (who: "edited" | "engineer") => actionChoices(graph, who).map(({ key }) => key);

test("what the guard rails refuse is not offered, and each person has rights of their own", () => {
  expect(keys("edited")).not.toContain("publish:cmd_vel");
  expect(keys("edited")).not.toContain("call_service:drive_manager/release_stop");
  expect(keys("edited")).not.toContain("publish:lamp");
  expect(keys("engineer")).toContain("publish:lamp");
  expect(keys("engineer")).not.toContain("publish:cmd_vel");
});

test("to stop the robot comes first, and what only few need last", () => {
  const labels = actionChoices(graph, "engineer").map(({ label }) => label);
  expect(labels[0]).toBe("Stop the robot");
  expect(labels.at(-1)).toBe("Publish on /lamp");
});
