// Playback is the clock of a recorded run: its position and speed.
import type {Contact} from './contacts.ts';

export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8];

export class Playback {
  /** In frames, with a fraction; the whole part is the frame to show. */
  position = 0;
  playing = true;
  speed = 1;
  /** Number of frames known so far. */
  frames = 0;
  first = 0;

  constructor(public step_s: number) {}

  /** Advances by `dt_s` of the viewer's time; stops at the last frame if all are known. */
  advance(dt_s: number, complete = true): void {
    if (!this.playing || this.frames === 0) return;
    // A tab that was suspended continues where it was.
    this.position += (Math.min(dt_s, 0.25) * this.speed) / this.step_s;
    if (this.position >= this.last) {
      this.position = this.last;
      if (complete) this.playing = false;
    }
  }

  get last(): number {
    return Math.max(this.first, this.frames - 1);
  }

  get frame(): number {
    return Math.floor(this.position);
  }

  get time_s(): number {
    return this.frame * this.step_s;
  }

  seek(frame: number): void {
    this.position = Math.min(this.last, Math.max(this.first, frame));
  }

  step(frames: number): void {
    this.playing = false;
    this.seek(this.frame + frames);
  }

  /** Plays or pauses; at the end it plays from the beginning. */
  toggle(): void {
    if (!this.playing && this.position >= this.last) this.position = this.first;
    this.playing = !this.playing;
  }

  /** Moves to the next speed of SPEEDS, up (1) or down (-1). */
  change(direction: number): void {
    const at = SPEEDS.indexOf(this.speed);
    this.speed = SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, at + direction))];
  }
}

/** Formats a time: "1:02.35". */
export function clock(time_s: number): string {
  const hundredths = Math.round(100 * time_s);
  const rest_s = (hundredths % 6000) / 100;
  return `${Math.floor(hundredths / 6000)}:${rest_s.toFixed(2).padStart(5, '0')}`;
}

/** Formats the duration of a contact up to a frame; `began` as in Pair. */
export function since(began: number, frame: number, step_s: number): string {
  return began >= 0 ? seconds((frame - began) * step_s) : `before ${seconds(~began * step_s)}`;
}

type When = Pick<Contact, 'begin' | 'end' | 'isOlder' | 'isLost'>;

/** Formats when a contact was: "10.57-11.12 s (0.55 s)", "from 10.57 s (at least 0.55 s)" while it lasts. */
export function whenOf(contact: When, lastFrame: number, step_s: number): string {
  const {begin, end, isOlder, isLost} = contact;
  const lasts = end < 0;
  const length = seconds(((lasts ? lastFrame + 1 : end) - begin) * step_s);
  const from = `${isOlder ? 'before ' : ''}${(begin * step_s).toFixed(2)}`;
  const when = lasts ? `from ${from} s` : `${from}-${(end * step_s).toFixed(2)} s`;
  return `${when} (${isOlder || lasts || isLost ? 'at least ' : ''}${length})`;
}

function seconds(time_s: number): string {
  return `${time_s.toFixed(2)} s`;
}
