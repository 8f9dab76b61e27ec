import { JsonSocket } from "../api/socket";
import type { ServerMessage, State } from "../api/types";

/** What the page knows, and since when. `receivedAt` is `performance.now()` in ms. */
interface LinkSnapshot {
  state: State | null;
  receivedAt: number | null;
  connected: boolean;
  /** Counts connections, so that what the server may have forgotten is set up again. */
  connection: number;
  version: string | null;
}

/** A console that says nothing for this long is connected to anew. */
const SILENCE_MS = 4000;

/**
 * What the state socket tells: the newest wins.
 *
 * Messages are folded in as they come and subscribers told once per turn of the event loop, so a
 * page that was busy renders the newest snapshot and never works through a backlog.
 */
export class RobotLink {
  private snapshot: LinkSnapshot = {
    state: null,
    receivedAt: null,
    connected: false,
    connection: 0,
    version: null,
  };
  private readonly listeners = new Set<() => void>();
  private readonly socket: JsonSocket<ServerMessage>;
  private notice: number | undefined;
  /** True until the first snapshot of a connection. */
  private fresh = true;

  /** @param onRefused called when a connection ended before it began: the console or the session. */
  constructor(onRefused: () => void) {
    this.socket = new JsonSocket("/api/state", {
      message: (message) => this.receive(message),
      open: (open) => {
        if (!open) this.change({ connected: false });
      },
      refused: onRefused,
      silenceMs: SILENCE_MS,
    });
  }

  readonly subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };

  readonly getSnapshot = (): LinkSnapshot => this.snapshot;

  open(): void {
    this.socket.open();
  }

  close(): void {
    window.clearTimeout(this.notice);
    this.notice = undefined;
    this.socket.close();
  }

  private receive(message: ServerMessage): void {
    if (message.type === "hello") {
      // A restarted server counts from zero again: its first snapshot replaces any older one.
      this.fresh = true;
      this.change({
        connected: true,
        connection: this.snapshot.connection + 1,
        version: message.version,
      });
    } else if (message.type === "state") {
      const newest = this.snapshot.state;
      if (!this.fresh && newest !== null && message.seq <= newest.seq) return;
      this.fresh = false;
      this.change({ state: message, receivedAt: performance.now() });
    }
  }

  private change(part: Partial<LinkSnapshot>): void {
    this.snapshot = { ...this.snapshot, ...part };
    this.notice ??= window.setTimeout(() => {
      this.notice = undefined;
      for (const listener of this.listeners) listener();
    }, 0);
  }
}
