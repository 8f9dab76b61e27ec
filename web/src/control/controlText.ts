import type { Control, Session } from "../api/types";

/** Time (s) in which an ask is to be answered; the console holds who asked to it. */
export const ANSWER_S = 20;

/** What control of the robot is to whoever looks. */
export interface ControlView {
  /** Whose it is: of this log-in, of another, or of nobody. */
  whose: "mine" | "other" | "nobody";
  text: string;
  /** Who asks whoever has it; empty when nobody does. */
  askedBy: string;
  /** This log-in asks for it: time (s) that is left for an answer. */
  waits: number | null;
  /** It was taken from this person: by whom, and why. */
  lost: { by: string; reason: string } | null;
  /** It can be had by a press, without a word: from oneself on another device. */
  own: boolean;
}

export function controlView(control: Control, session: Session, elapsed: number): ControlView {
  const { holder, holder_key, asked_by, asked_key, asked, taken_key, reason } = control;
  const mine = holder !== "" && holder_key === session.key;
  const asks = asked_by !== "" && asked_key === session.key;
  const lost = holder !== "" && taken_key === session.key;
  return {
    whose: holder === "" ? "nobody" : mine ? "mine" : "other",
    text: mine ? "You have control" : `${holder} has control`,
    askedBy: mine ? asked_by : "",
    waits: asks && holder !== "" ? Math.max(0, ANSWER_S - asked - elapsed) : null,
    lost: lost ? { by: holder, reason } : null,
    own: own(control, session),
  };
}

const own = (control: Control, session: Session) =>
  session.account && control.holder === session.user && control.holder_key !== session.key;
