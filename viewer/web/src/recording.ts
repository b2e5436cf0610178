// The button that records the run, and where the file is.
import { get } from "./dom";
import type { Status } from "./protocol";

export class Recording {
  private on = false;

  constructor(private readonly ask: (message: Record<string, unknown>) => void) {}

  toggle() {
    this.ask({ do: this.on ? "end" : "record" });
  }

  showStatus(status: Status) {
    const recording = status.program.recording;
    this.on = Boolean(recording);
    const button = get("record");
    button.setAttribute("aria-pressed", String(this.on));
    button.textContent = this.on ? "Recording" : "Record";
    const lost = recording && recording.dropped > 0 ? `, ${recording.dropped} lost` : "";
    button.title = recording ? `${recording.file}: ${recording.frames} frames${lost}. Press to end it (V)` : "Record the run into a file (V)";
    document.body.dataset.recording = recording ? recording.file : "";
  }
}
