// The line to the program: connects, comes back after a loss, acknowledges what was taken in.
import { readFrames, type Frames, type ServerMessage } from "./protocol";

export interface Listener {
  received(message: ServerMessage): void;
  frames(frames: Frames): void;
  linked(up: boolean): void;
  /** After a loss, at each try: "other": another program answers, which has another address. */
  gone(why: "nobody" | "other"): void;
}

export class Connection {
  private socket: WebSocket | null = null;
  private wait_ms = 250;

  constructor(private readonly listener: Listener) {
    this.open();
  }

  private open() {
    const address = new URL("ws", location.href);
    address.protocol = "ws:";
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.wait_ms = 250;
      this.listener.linked(true);
    };
    socket.onmessage = (event) => {
      if (typeof event.data === "string") {
        this.listener.received(JSON.parse(event.data) as ServerMessage);
        return;
      }
      const frames = readFrames(event.data as ArrayBuffer);
      this.listener.frames(frames);
      this.send({ do: "ack", seq: frames.sequence });
    };
    socket.onclose = () => {
      this.socket = null;
      this.listener.linked(false);
      void this.findOut();
      setTimeout(() => this.open(), this.wait_ms);
      this.wait_ms = Math.min(4000, 2 * this.wait_ms);
    };
    this.socket = socket;
  }

  /** Whether anybody is there. */
  private async findOut() {
    const status = await fetch("geometry", { method: "GET" }).then((answer) => answer.status, () => 0);
    if (status === 0 || status === 403) this.listener.gone(status === 403 ? "other" : "nobody");
  }

  /** False when there is no line to send it by. */
  send(message: Record<string, unknown>): boolean {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }
}
