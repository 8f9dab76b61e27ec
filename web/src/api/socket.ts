const BACKOFF_MIN_MS = 500;
const BACKOFF_MAX_MS = 3000;

/** Milliseconds to wait before a connection is tried again. */
export function backoff(attempt: number): number {
  return Math.min(BACKOFF_MAX_MS, BACKOFF_MIN_MS * 2 ** Math.max(0, attempt));
}

interface Handlers<Message> {
  message: (message: Message) => void;
  /** Called with true once it can be sent to, and with false when it is lost. */
  open?: (open: boolean) => void;
  /**
   * Called when a connection ended before its first message, which is also how a browser shows a
   * refused session.
   */
  refused?: () => void;
  /** A connection that says nothing for this long is given up and opened anew. */
  silenceMs?: number;
}

/** A websocket of JSON messages that comes back by itself after every loss, until closed. */
export class JsonSocket<Message> {
  private socket: WebSocket | null = null;
  private failures = 0;
  private retry: number | undefined;
  private watchdog: number | undefined;
  private closed = true;

  constructor(
    private readonly path: string,
    private readonly on: Handlers<Message>,
  ) {}

  open(): void {
    this.closed = false;
    this.connect();
  }

  close(): void {
    this.closed = true;
    window.clearTimeout(this.retry);
    window.clearTimeout(this.watchdog);
    this.socket?.close();
    this.socket = null;
  }

  /** Sends a message if there is a connection. */
  send(message: unknown): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  /** Bytes that the browser has been given and has not sent. */
  get waiting(): number {
    return this.socket?.bufferedAmount ?? 0;
  }

  private connect(): void {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}${this.path}`);
    this.socket = socket;
    let greeted = false;
    this.watch(socket);
    socket.onopen = () => {
      if (socket === this.socket) this.on.open?.(true);
    };
    socket.onmessage = (event: MessageEvent<string>) => {
      if (socket !== this.socket) return;
      greeted = true;
      this.failures = 0;
      this.watch(socket);
      this.on.message(JSON.parse(event.data) as Message);
    };
    socket.onclose = () => {
      if (socket !== this.socket) return;
      if (!greeted) this.on.refused?.();
      this.lost();
    };
  }

  private watch(socket: WebSocket): void {
    window.clearTimeout(this.watchdog);
    if (this.on.silenceMs === undefined) return;
    this.watchdog = window.setTimeout(() => {
      // A half-open connection may take minutes to report its close: do not wait for it.
      if (socket !== this.socket) return;
      socket.close();
      this.lost();
    }, this.on.silenceMs);
  }

  private lost(): void {
    window.clearTimeout(this.watchdog);
    window.clearTimeout(this.retry);
    this.socket = null;
    if (this.closed) return;
    this.on.open?.(false);
    this.retry = window.setTimeout(() => this.connect(), backoff(this.failures));
    this.failures += 1;
  }
}
