// The connection to `throng view`: messages in, questions out, again when it was lost.
// One rule: a lost connection is shown and mended, never fatal.

export interface SocketEvents {
  connected(): void;
  lost(): void;
  binary(buffer: ArrayBuffer): void;
  text(json: any): void;
}

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
    socket.onopen = () => {
      this.wait_ms = FIRST_WAIT_MS;
      this.events.connected();
    };
    socket.onmessage = (message) => {
      if (socket !== this.socket) return;
      if (typeof message.data === 'string') this.events.text(JSON.parse(message.data));
      else this.events.binary(message.data);
    };
    socket.onclose = () => {
      if (socket !== this.socket) return;
      this.events.lost();
      this.waiting = window.setTimeout(() => this.connect(), this.wait_ms);
      this.wait_ms = Math.min(LONGEST_WAIT_MS, this.wait_ms * 2);
    };
  }
}
