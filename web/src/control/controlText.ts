import type { Control, Session } from "../api/types";
import { t } from "../texts/text";

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
  /** What who wants it does; a sentence. */
  remedy: string;
}

export function controlView(control: Control, session: Session, elapsed: number): ControlView {
  const { holder, holder_key, asked_by, asked_key, asked, taken_key, reason } = control;
  const mine = holder !== "" && holder_key === session.key;
  const asks = asked_by !== "" && asked_key === session.key;
  const lost = holder !== "" && taken_key === session.key;
  const other = named(holder, session);
  return {
    whose: holder === "" ? "nobody" : mine ? "mine" : "other",
    text: mine ? t("You have control") : t("{name} has control", { name: other }),
    askedBy: mine && asked_by !== "" ? named(asked_by, session) : "",
    waits: asks && holder !== "" ? Math.max(0, ANSWER_S - asked - elapsed) : null,
    lost: lost ? { by: other, reason } : null,
    own: own(control, session),
    remedy: remedy(control, session),
  };
}

function remedy(control: Control, session: Session): string {
  if (own(control, session)) return t("Take it in the bar at the top.");
  return session.role === "engineer"
    ? t("Ask for it in the bar at the top, or take it there and say why.")
    : t("Ask for it in the bar at the top.");
}

const own = (control: Control, session: Session) =>
  session.account && control.holder === session.user && control.holder_key !== session.key;

/** Who that is, as a sentence begins. Where people log in with tokens, all of a role may have one
 * name. */
const named = (name: string, session: Session) =>
  name === session.user ? t("Another page ({name})", { name }) : name;
