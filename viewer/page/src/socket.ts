// The connection to `throng view`: messages in, questions out, again when it was lost.
// One rule: a lost connection is shown and mended, never fatal.

export interface SocketEvents {
  /** Before the first message of a connection. */
  connected(): void;
  lost(): void;
  /** The server takes no more pages; `reason` says how many are open. */
  full(reason: string): void;
  binary(buffer: ArrayBuffer): void;
  text(json: any): void;
}

const TRY_AGAIN_LATER = 1013; // as the server closes where too many pages are open
const FIRST_WAIT_MS = 250;
const LONGEST_WAIT_MS = 2000;

export class Connection {
  private socket: WebSocket | null = null;
  private wait_ms = FIRST_WAIT_MS;
  private waiting = 0;

  constructor(
    private readonly url: string,
    private readonly events: SocketEvents,
  ) {
    this.connect();
  }

  get open(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  send(question: object): void {
    if (this.open) this.socket!.send(JSON.stringify(question));
  }

  /** At once, instead of when the wait is over. */
  retry(): void {
    clearTimeout(this.waiting);
    this.connect();
  }

  private connect(): void {
    const socket = new WebSocket(this.url);
    this.socket = socket;
    socket.binaryType = 'arraybuffer';
    let isNew = true;
    socket.onmessage = (message) => {
      if (socket !== this.socket) return;
      if (isNew) {
        isNew = false;
        this.wait_ms = FIRST_WAIT_MS;
        this.events.connected();
      }
      if (typeof message.data === 'string') this.events.text(JSON.parse(message.data));
      else this.events.binary(message.data);
    };
    socket.onclose = ({code, reason}) => {
      if (socket !== this.socket) return;
      if (code === TRY_AGAIN_LATER) this.events.full(reason);
      else this.events.lost();
      this.waiting = window.setTimeout(() => this.connect(), this.wait_ms);
      this.wait_ms = Math.min(LONGEST_WAIT_MS, this.wait_ms * 2);
    };
  }
}
