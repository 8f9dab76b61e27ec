import type { GoalCheck } from "../api/types";

/** What tests begin with: a goal that the robot can be sent to. */
export const goalCheck: GoalCheck = {
  ok: true,
  x: 1,
  y: 2,
  yaw: null,
  reason: "",
  message: "",
  nearest: null,
  length: 4.2,
  duration: 20.7,
  way: [],
  heading_used: true,
  note: "",
};
