import { JsonSocket } from "../api/socket";
import type { HandAnswer, HandRequest } from "../api/types";
import { t } from "../texts/text";
import type { Twist } from "./push";

/** What the page knows of the wheel. */
export interface HandState {
  connected: boolean;
  yours: boolean;
  limits: Twist;
  /** Why the wheel was not given, or was lost; for a while. */
  message: string;
  /** Who asks for it; for a while. */
  askedBy: string;
  /** The wheel was asked for, and no answer has come yet. */
  asking: boolean;
}

export const AWAY: HandState = {
  connected: false,
  yours: false,
  limits: { vx: 0, vy: 0, omega: 0 },
  message: "",
  askedBy: "",
  asking: false,
};

/** A sentence of what was is taken away before somebody takes it for what is. */
const TOLD_MS = 12_000;
/** More than this waits in the browser only while the network takes nothing: what is old then is not
 * to arrive after it. */
const MOST_WAITING = 1000;

/** The page's end of the wheel: the console's word on who has it, and the hand's on what to do. */
export class HandLink {
  private state = AWAY;
  private readonly listeners = new Set<() => void>();
  private readonly socket: JsonSocket<HandAnswer>;
  private forgets: number | undefined;

  constructor() {
    this.socket = new JsonSocket("/api/hand", {
      message: (answer) => this.receive(answer),
      open: (connected) => {
        const lost = this.state.yours && !connected;
        this.change({
          ...AWAY,
          connected,
          message: lost ? t("The connection was lost, and the wheel with it. Take it again.") : "",
        });
      },
    });
  }

  readonly subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };

  readonly getSnapshot = (): HandState => this.state;

  open(): void {
    this.socket.open();
  }

  /** The console gives the wheel up for a page that has gone. */
  close(): void {
    this.socket.close();
    this.change(AWAY);
  }

  take(over: boolean): void {
    this.change({ ...this.state, message: "", asking: true });
    this.send({ type: over ? "take over" : "take" });
  }

  give(): void {
    this.send({ type: "give" });
  }

  ask(): void {
    this.send({ type: "ask" });
  }

  drive(twist: Twist): void {
    if (!this.state.yours || this.socket.waiting > MOST_WAITING) return;
    this.send({ type: "drive", t: performance.now() / 1000, ...twist });
  }

  private send(request: Pick<HandRequest, "type"> & Partial<HandRequest>): void {
    this.socket.send(request);
  }

  private receive(answer: HandAnswer): void {
    const { yours, message, asked_by, max_vx, max_vy, max_omega } = answer;
    // Who has asked waits until the wheel is given up.
    const askedBy = asked_by || (yours ? this.state.askedBy : "");
    this.change({
      connected: true,
      yours,
      limits: { vx: max_vx, vy: max_vy, omega: max_omega },
      message,
      askedBy,
      asking: false,
    });
  }

  private change(state: HandState): void {
    this.state = state;
    window.clearTimeout(this.forgets);
    if (state.message !== "" || state.askedBy !== "") {
      this.forgets = window.setTimeout(
        () => this.change({ ...this.state, message: "", askedBy: "" }),
        TOLD_MS,
      );
    }
    for (const listener of this.listeners) listener();
  }
}
