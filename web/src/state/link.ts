import { backoff } from "../api/socket";
import type { ServerMessage, Session, State } from "../api/types";

/** What the page knows, and since when. `receivedAt` and the clock are `performance.now()` ms. */
export interface LinkSnapshot {
  state: State | null;
  receivedAt: number | null;
  connected: boolean;
  /** Counts connections, so that what the server may have forgotten is set up again. */
  connection: number;
  session: Session | null;
  version: string | null;
}

/** A connection that says nothing for this long is given up and opened anew. */
const SILENCE_MS = 4000;

/**
 * The state socket: newest wins, reconnects by itself.
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
    session: null,
    version: null,
  };
  private readonly listeners = new Set<() => void>();
  private socket: WebSocket | null = null;
  private failures = 0;
  private retry: number | undefined;
  private watchdog: number | undefined;
  private notice: number | undefined;
  private closed = true;
  /** True until the first snapshot of a connection. */
  private fresh = true;

  /**
   * @param onRefused called when a connection ended before its first message, which is also how a
   *   browser shows a refused session: the caller asks the API which of the two it is.
   */
  constructor(
    private readonly url: string,
    private readonly onRefused: () => void,
  ) {}

  readonly subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };

  readonly getSnapshot = (): LinkSnapshot => this.snapshot;

  open(): void {
    this.closed = false;
    this.connect();
  }

  close(): void {
    this.closed = true;
    window.clearTimeout(this.retry);
    window.clearTimeout(this.watchdog);
    window.clearTimeout(this.notice);
    this.notice = undefined;
    this.socket?.close();
    this.socket = null;
  }

  private connect(): void {
    const socket = new WebSocket(this.url);
    this.socket = socket;
    let greeted = false;
    this.watch(socket);
    socket.onmessage = (event: MessageEvent<string>) => {
      if (socket !== this.socket) return;
      greeted = true;
      this.failures = 0;
      this.watch(socket);
      this.receive(JSON.parse(event.data) as ServerMessage);
    };
    socket.onclose = () => {
      if (socket !== this.socket) return;
      if (!greeted) this.onRefused();
      this.lost();
    };
  }

  private receive(message: ServerMessage): void {
    if (message.type === "hello") {
      const { session, version } = message;
      // A restarted server counts from zero again: its first snapshot replaces any older one.
      this.fresh = true;
      this.change({
        connected: true,
        connection: this.snapshot.connection + 1,
        session,
        version,
      });
    } else if (message.type === "state") {
      const newest = this.snapshot.state;
      if (!this.fresh && newest !== null && message.seq <= newest.seq) return;
      this.fresh = false;
      this.change({ state: message, receivedAt: performance.now() });
    }
  }

  private watch(socket: WebSocket): void {
    window.clearTimeout(this.watchdog);
    this.watchdog = window.setTimeout(() => {
      // A half-open connection may take minutes to report its close: do not wait for it.
      if (socket !== this.socket) return;
      socket.close();
      this.lost();
    }, SILENCE_MS);
  }

  private lost(): void {
    window.clearTimeout(this.watchdog);
    window.clearTimeout(this.retry);
    this.socket = null;
    if (this.closed) return;
    this.change({ connected: false });
    this.retry = window.setTimeout(() => this.connect(), backoff(this.failures));
    this.failures += 1;
  }

  private change(part: Partial<LinkSnapshot>): void {
    this.snapshot = { ...this.snapshot, ...part };
    this.notice ??= window.setTimeout(() => {
      this.notice = undefined;
      for (const listener of this.listeners) listener();
    }, 0);
  }
}
