// Sources of frames: a live run or a log behind the server, or a recording in this page.
import type {PastContact} from './card.ts';
import {ContactLog} from './contacts.ts';
import {clock, Playback} from './playback.ts';
import {DensityLog} from './density.ts';
import {ProximityLog} from './proximity.ts';
import {decodeContacts, decodeFrame, decodePositions, decodeProximity, decodeRun, kindOf, type Frame, type Run, type Shortfall} from './protocol.ts';
import {Replay} from './replay.ts';

// The connection to `throng view` sends requests, receives messages and reconnects after a loss.

interface SocketEvents {
  /** Called before the first message of a connection. */
  connected(): void;
  lost(): void;
  /** The server accepts no more pages; `reason` states how many are open. */
  full(reason: string): void;
  binary(buffer: ArrayBuffer): void;
  text(json: any): void;
}

/** Returns the address of the socket of a page: wss for https, under the same path. */
export function socketUrl(page: string): string {
  const url = new URL('ws', page);
  url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
  return url.href;
}

const TRY_AGAIN_LATER = 1013; // close code of the server when too many pages are open
const FIRST_WAIT_MS = 250;
const MAX_WAIT_MS = 2000;

class Connection {
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

  /** Reconnects at once, without waiting. */
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
      this.wait_ms = Math.min(MAX_WAIT_MS, this.wait_ms * 2);
    };
  }
}

export interface Series {
  frames: number;
  pairs: ArrayLike<number>;
  frame_ms: ArrayLike<number>;
  problem: string;
  shortfalls: Shortfall[];
}

export interface SourceEvents {
  run(run: Run): void;
  frame(frame: Frame): void;
  series(series: Series): void;
  history(id: number, past: PastContact[]): void;
  /** Called after a change of Source.proximity. */
  proximity(): void;
  /** Called after a change of Source.density. */
  density(): void;
  /** Shows a notice in the middle of the page; '' hides it. `retry` adds a button. */
  notice(title: string, detail?: string, retry?: () => void): void;
}

export interface Source {
  readonly playback: Playback | null; // null: live
  /** Number of frames that did not reach this page. */
  readonly dropped: number;
  /** Whether a live run has finished. */
  readonly isEnded: boolean;
  /** Whether all frames of a recorded run are known. */
  readonly isComplete: boolean;
  /** Called before every picture, with the time since the previous one. */
  tick(dt_s: number): void;
  requestHistory(id: number, frame: number): void;
  /** All contacts of a recorded run, those of the latest LIVE_S of a live one. */
  readonly contacts: ContactLog;
  /** Begins to fill `contacts`. */
  loadContacts(): void;
  /** Distances of one body, for runs with proximity rows; of the latest LIVE_S of a live run. */
  readonly proximity: ProximityLog;
  /** Where people were; in a live run since this page was opened. */
  readonly density: DensityLog;
  /** Begins to fill `density` for a span of a recorded run: first <= frame < end. */
  loadDensity(first: number, end: number): void;
  /** Begins to fill `proximity` for a body; -1: for none. */
  loadProximity(body: number): void;
}

const ANSWER_MS = 2000;
/** Time between two requests for new contacts. */
const CONTACTS_MS = 500;
/** Time between two requests for new distances. */
const PROXIMITY_MS = 250;
const LIVE_S = 60;
const DENSITY_S = 0.1;
/** Maximum numbers of samples of a density, and of places in them. */
const MAX_SAMPLES = 600;
const MAX_PLACES = 5e6;
const SAMPLES = 600;

/** ServerSource provides the live run or log of the server. */
export class ServerSource implements Source {
  playback: Playback | null = null;
  dropped = 0;
  decode_ms = 0;
  private readonly connection: Connection;
  private run: Run | null = null;
  isComplete = false;
  private shown = -1;
  private requested = -1;
  private requestedAt = 0;
  private lastSeq = 0;
  private lastTime_s = -1;
  private receivedAt = 0;
  private indexAt = 0;
  isEnded = false;
  readonly contacts = new ContactLog();
  private readonly pairs: number[] = [];
  private readonly frame_ms: number[] = [];
  private wantsContacts = false;
  private nextChange = 0;
  private contactsAt = 0;
  /** Whether the log was read completely when contacts were requested last. */
  private wasComplete = false;
  readonly proximity = new ProximityLog();
  private proximityAt = 0;
  readonly density = new DensityLog();
  private densityAt = 0;
  /** The next frame to sample. */
  private densityNext = 0;
  private densityEvery = 1;

  constructor(
    url: string,
    private readonly events: SourceEvents,
  ) {
    this.connection = new Connection(url, {
      connected: () => {
        this.requested = -1;
        this.lastSeq = this.contactsAt = this.proximityAt = this.densityAt = 0;
        events.notice('');
      },
      lost: () => events.notice('Connection lost', 'throng view does not answer; trying again'),
      full: (reason) =>
        events.notice(reason, 'throng view serves no more pages; this page opens when another one is closed', () =>
          this.connection.retry(),
        ),
      binary: (buffer) => this.binary(buffer),
      text: (json) => this.text(json),
    });
  }

  tick(dt_s: number): void {
    const {playback, connection} = this;
    const now = performance.now();
    this.requestContacts(now);
    this.requestProximity(now);
    this.requestDensity(now);
    if (!playback) {
      if (connection.open && this.run && !this.isEnded && this.receivedAt > 0 && now - this.receivedAt > 2500)
        this.events.notice('No frames', 'waiting for the next frame');
      return;
    }
    playback.advance(dt_s, this.isComplete);
    if (!connection.open) return;
    if (!this.isComplete && now > this.indexAt) {
      this.indexAt = now + 500;
      connection.send({index: true});
    }
    const waiting = this.requested >= 0 && now - this.requestedAt < ANSWER_MS;
    if (playback.frame === this.shown || waiting || playback.frames === 0) return;
    this.requested = playback.frame;
    this.requestedAt = now;
    connection.send({frame: this.requested});
  }

  requestHistory(id: number, frame: number): void {
    this.connection.send({history: id, frame});
  }

  private binary(buffer: ArrayBuffer): void {
    const start = performance.now();
    if (kindOf(buffer) === 'contacts') return this.takeContacts(buffer);
    if (kindOf(buffer) === 'proximity') return this.takeProximity(buffer);
    if (kindOf(buffer) === 'positions') return this.takePositions(buffer);
    if (kindOf(buffer) === 'run') {
      const run = decodeRun(buffer);
      const isSame = this.run !== null && this.run.run_id === run.run_id && this.run.mode === run.mode;
      this.run = run;
      this.shown = this.requested = -1;
      this.isEnded = false;
      this.lastTime_s = -1;
      this.pairs.length = this.frame_ms.length = 0;
      this.contacts.clear();
      this.nextChange = this.contactsAt = 0;
      this.loadProximity(this.proximity.body, true);
      this.density.reset(run, 0, run.mode === 'live' ? Infinity : -1);
      if (run.mode === 'log' && !(isSame && this.playback)) this.playback = new Playback(run.step_s);
      if (run.mode === 'live') this.playback = null;
      this.events.run(run);
      return;
    }
    const frame = decodeFrame(buffer);
    if (!this.run || frame.avatars !== this.run.avatars) return;
    if (this.playback) {
      this.shown = this.requested;
      this.requested = -1;
    } else {
      if (this.lastSeq > 0 && frame.seq > this.lastSeq) this.dropped += frame.seq - this.lastSeq - 1;
      this.lastSeq = frame.seq;
      this.receivedAt = performance.now();
      this.lastTime_s = frame.time_s;
      this.remember(frame);
      this.density.addFrame(this.run, frame);
      if (this.isEnded) this.showEnd();
      else this.events.notice('');
    }
    this.events.frame(frame);
    this.decode_ms = performance.now() - start;
  }

  loadContacts(): void {
    this.wantsContacts = true;
  }

  /** A request without an answer is repeated. */
  private requestContacts(now: number): void {
    if (!this.wantsContacts || !this.run || !this.connection.open || now < this.contactsAt) return;
    this.contactsAt = now + ANSWER_MS;
    this.wasComplete = this.isComplete;
    const since = this.playback || this.lastTime_s < LIVE_S ? {} : {since: Math.floor((this.lastTime_s - LIVE_S) / this.run.step_s)};
    this.connection.send({contacts: this.nextChange, ...since});
  }

  private takeContacts(buffer: ArrayBuffer): void {
    const {first, known, frame, changes} = decodeContacts(buffer);
    // An answer to a repeated request has come before.
    if (!this.run || first < this.nextChange) return;
    this.nextChange = first + changes.length;
    this.contacts.take(changes, frame);
    if (!this.playback) this.contacts.forget(frame - LIVE_S / this.run.step_s);
    const isAll = this.nextChange >= known;
    this.contactsAt = !isAll ? 0 : this.playback && this.wasComplete ? Infinity : performance.now() + CONTACTS_MS;
  }

  loadProximity(body: number, isAnew = body !== this.proximity.body): void {
    if (!isAnew) return;
    this.proximity.reset(body);
    this.proximityAt = 0;
  }

  /** A request without an answer is repeated. */
  private requestProximity(now: number): void {
    const {proximity} = this;
    if (proximity.body < 0 || !this.run || !this.connection.open || now < this.proximityAt) return;
    this.proximityAt = now + ANSWER_MS;
    this.connection.send({proximity: proximity.body, since: proximity.to});
  }

  private takeProximity(buffer: ArrayBuffer): void {
    const {proximity, playback, run} = this;
    if (!run || !proximity.take(decodeProximity(buffer))) return;
    if (!playback) proximity.forget(proximity.to - LIVE_S / run.step_s);
    const isAll = !playback || proximity.to >= playback.frames;
    this.proximityAt = !isAll ? 0 : playback && this.isComplete ? Infinity : performance.now() + PROXIMITY_MS;
    // Waiting for the next picture would slow down a log of many frames.
    if (!isAll) this.requestProximity(performance.now());
    this.events.proximity();
  }

  loadDensity(first: number, end: number): void {
    const {density, run, playback} = this;
    if (!run || !playback || (density.first === first && density.end === end)) return;
    density.reset(run, first, end);
    const max = Math.max(20, Math.min(MAX_SAMPLES, Math.floor(MAX_PLACES / run.avatars)));
    const frames = Math.min(end, playback.frames) - first;
    this.densityEvery = Math.max(1, Math.round(DENSITY_S / run.step_s), Math.ceil(frames / max));
    this.densityNext = first;
    this.densityAt = 0;
  }

  /** A request without an answer is repeated. */
  private requestDensity(now: number): void {
    const {density, playback, connection} = this;
    if (!playback || !this.run || density.end < 0 || !connection.open || now < this.densityAt) return;
    const end = Math.min(density.end, playback.frames);
    this.densityAt = now + (this.densityNext < end ? ANSWER_MS : PROXIMITY_MS);
    if (this.densityNext >= end) return;
    connection.send({positions: this.densityNext, to: end - 1, every: this.densityEvery});
  }

  private takePositions(buffer: ArrayBuffer): void {
    const {density, run} = this;
    const {samples, from, to, places} = decodePositions(buffer);
    if (!run || from !== this.densityNext || places.length !== 2 * samples * run.avatars) return;
    for (let i = 0; i < samples; ++i)
      density.add(run, places, (id) => 2 * (i * run.avatars + id), Math.min(to, from + i * this.densityEvery));
    this.densityNext = to;
    this.densityAt = 0;
    this.requestDensity(performance.now());
    this.events.density();
  }

  private remember(frame: Frame): void {
    this.pairs.push(frame.pairs);
    this.frame_ms.push(frame.frame_ms);
    if (this.pairs.length > SAMPLES) {
      this.pairs.shift();
      this.frame_ms.shift();
    }
    this.events.series({frames: 0, pairs: this.pairs, frame_ms: this.frame_ms, problem: '', shortfalls: []});
  }

  private text(json: any): void {
    if (json.index && this.playback) {
      this.isComplete = json.index.complete;
      this.playback.frames = json.index.frames;
      this.playback.first = json.index.first_shown;
      if (this.playback.position < this.playback.first) this.playback.seek(this.playback.first);
      this.events.series(json.index);
    }
    if (json.history !== undefined) this.events.history(json.history, json.pairs);
    if (json.waiting !== undefined) {
      this.run = null;
      this.isEnded = false;
      const hint = json.waiting || `start one: ${json.start}`;
      this.events.notice('Waiting for a run over LCM', `listening to ${json.lcm}\n${hint}`);
    }
    if (json.end && this.run && !this.playback) this.showEnd();
  }

  private showEnd(): void {
    this.isEnded = true;
    const last = this.lastTime_s < 0 ? '' : `its last frame is at ${clock(this.lastTime_s)}; `;
    this.events.notice('The run has finished', `${last}the next run will appear here`);
  }
}

export class FileSource implements Source {
  readonly playback: Playback;
  readonly dropped = 0;
  readonly isEnded = false;
  readonly isComplete = true;
  readonly contacts = new ContactLog();
  private shown = -1;

  constructor(
    private readonly replay: Replay,
    private readonly events: SourceEvents,
  ) {
    this.playback = new Playback(replay.run.step_s);
    this.playback.frames = replay.frames;
    // The page must know its source first.
    queueMicrotask(() => {
      events.run(replay.run);
      const {frames, pairs, frame_ms, problem, shortfalls} = replay;
      events.series({frames, pairs, frame_ms, problem, shortfalls});
    });
  }

  tick(dt_s: number): void {
    this.playback.advance(dt_s);
    if (this.playback.position === this.shown) return;
    this.shown = this.playback.position;
    this.events.frame(this.replay.frameAt(this.shown));
  }

  loadContacts(): void {
    if (this.contacts.lastFrame < 0) this.contacts.take(this.replay.changes(), this.replay.frames - 1);
  }

  readonly proximity = new ProximityLog();
  readonly density = new DensityLog();

  loadDensity(first: number, end: number): void {
    const {density, replay} = this;
    if (density.first === first && density.end === end) return;
    density.reset(replay.run, first, end);
    replay.sampleDensity(density);
  }

  loadProximity(body: number): void {
    const {proximity, replay} = this;
    if (body === proximity.body) return;
    proximity.reset(body);
    if (body >= 0) proximity.take(replay.proximity(body));
    proximity.note = replay.isProximityDropped ? 'left out of this file, which they would make too large; throng view LOG shows them' : '';
    this.events.proximity();
  }

  requestHistory(id: number, frame: number): void {
    const past = this.replay
      .history(id, frame, 40)
      .map((s): PastContact => [s.began, s.end > frame ? -1 : s.end, s.a, s.b, s.partA, s.partB]);
    this.events.history(id, past);
  }
}
