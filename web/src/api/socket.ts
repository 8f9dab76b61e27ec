const BACKOFF_MIN_MS = 500;
const BACKOFF_MAX_MS = 3000;

/** Milliseconds to wait before a connection is tried again. */
export function backoff(attempt: number): number {
  return Math.min(BACKOFF_MAX_MS, BACKOFF_MIN_MS * 2 ** Math.max(0, attempt));
}

/** A websocket of JSON messages that comes back by itself after every loss, until closed. */
export class JsonSocket<Message> {
  private socket: WebSocket | null = null;
  private failures = 0;
  private retry: number | undefined;
  private closed = true;

  constructor(
    private readonly path: string,
    private readonly onMessage: (message: Message) => void,
    /** Called with true once it can be sent to, and with false when it is lost. */
    private readonly onOpen: (open: boolean) => void = () => {},
  ) {}

  open(): void {
    this.closed = false;
    this.connect();
  }

  close(): void {
    this.closed = true;
    window.clearTimeout(this.retry);
    this.socket?.close();
    this.socket = null;
  }

  /** Sends a message if there is a connection; whether there was one. */
  send(message: unknown): boolean {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  private connect(): void {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}${this.path}`);
    this.socket = socket;
    socket.onopen = () => {
      if (socket === this.socket) this.onOpen(true);
    };
    socket.onmessage = (event: MessageEvent<string>) => {
      if (socket !== this.socket) return;
      this.failures = 0;
      this.onMessage(JSON.parse(event.data) as Message);
    };
    socket.onclose = () => {
      if (socket !== this.socket) return;
      this.socket = null;
      if (this.closed) return;
      this.onOpen(false);
      this.retry = window.setTimeout(() => this.connect(), backoff(this.failures));
      this.failures += 1;
    };
  }
}
