// A video of a span of a recording, drawn at the pace of the encoder: no picture is left out on a slow machine.
import {ArrayBufferTarget, Muxer} from 'webm-muxer';
import {el, setText} from './dom.ts';
import {clock, type Playback} from './playback.ts';
import type {Stage} from './stage.ts';

/** As films: on a machine without a graphics card each picture takes a fifth of a second. */
const FPS = 25;
const DEFAULT_S = 10;
const KEY_PICTURES = 2 * FPS;
/** Encoders that WebM holds, the better one first: names for the browser and for the file. */
const CODECS = [
  ['vp09.00.40.08', 'V_VP9'],
  ['vp8', 'V_VP8'],
] as const;
const BITS_PER_PIXEL = 0.13;
const MAX_QUEUED = 3;
const PROGRESS_PICTURES = 5;
const TEXT_SHARE = 0.026;

/** Video encodes pictures of one size into a WebM file. */
class Video {
  private readonly muxer: Muxer<ArrayBufferTarget>;
  private readonly encoder: VideoEncoder;
  private error: Error | null = null;
  private pictures = 0;

  /** Throws an Error if the browser has no encoder for this size. */
  static async open(width: number, height: number): Promise<Video> {
    // Browsers offer encoders to secure pages only: https, this machine, files.
    if (!('VideoEncoder' in window)) throw new Error('this browser cannot encode video here; throng render can');
    const bitrate = Math.round(BITS_PER_PIXEL * width * height * FPS);
    for (const [codec, name] of CODECS) {
      const config = {codec, width, height, bitrate, framerate: FPS};
      if ((await VideoEncoder.isConfigSupported(config)).supported) return new Video(config, name);
    }
    throw new Error(`this browser encodes no WebM of ${width} x ${height} pixels; throng render can`);
  }

  private constructor(config: VideoEncoderConfig, codec: string) {
    const {width, height} = config;
    this.muxer = new Muxer({target: new ArrayBufferTarget(), video: {codec, width, height, frameRate: FPS}});
    this.encoder = new VideoEncoder({
      output: (chunk, meta) => this.muxer.addVideoChunk(chunk, meta),
      error: (error) => (this.error = error),
    });
    this.encoder.configure(config);
  }

  /** Appends a picture; waits while the encoder is behind. */
  async add(picture: HTMLCanvasElement): Promise<void> {
    const at_us = (index: number): number => Math.round((1e6 * index) / FPS);
    const timestamp = at_us(this.pictures);
    const duration = at_us(this.pictures + 1) - timestamp;
    // Bytes are encoded several times faster than a canvas.
    const {data, width, height} = picture.getContext('2d')!.getImageData(0, 0, picture.width, picture.height);
    const frame = new VideoFrame(data, {format: 'RGBX', codedWidth: width, codedHeight: height, timestamp, duration});
    this.encoder.encode(frame, {keyFrame: this.pictures % KEY_PICTURES === 0});
    frame.close();
    ++this.pictures;
    do await new Promise((done) => setTimeout(done));
    while (this.encoder.encodeQueueSize > MAX_QUEUED && !this.error);
    if (this.error) throw this.error;
  }

  async finish(): Promise<Blob> {
    await this.encoder.flush();
    this.encoder.close();
    this.muxer.finalize();
    return new Blob([this.muxer.target.buffer], {type: 'video/webm'});
  }

  close(): void {
    if (this.encoder.state !== 'closed') this.encoder.close();
  }
}

/** What a video shows, and the page that shows it. */
export interface Filmed {
  readonly name: string;
  readonly playback: Playback;
  /** Shows a position between frames; resolves once its frame has arrived. */
  show(position: number): Promise<void>;
}

/** VideoPanel saves the span that its fields name, at the speed of the timeline. */
export class VideoPanel {
  private isStopped = false;
  isFilming = false;

  /** `filmed` returns null where nothing can be sought. `save` offers a file to the reader. */
  constructor(
    private readonly stage: Stage,
    private readonly filmed: () => Filmed | null,
    private readonly save: (name: string, file: Blob) => void,
    private readonly failed: (error: Error) => void,
  ) {
    el('videoButton').onclick = () => {
      if (this.isFilming) this.isStopped = true;
      else void this.film();
    };
  }

  /** Returns the first and last position, in frames. Throws an Error if the fields name no span of the recording. */
  private span({first, last, step_s, position}: Playback): [number, number] {
    const inside = (frame: number): number => Math.min(last, Math.max(first, frame));
    const value = (id: string): number => el<HTMLInputElement>(id).valueAsNumber / step_s;
    const to = value('videoTo');
    const from = value('videoFrom');
    if (from >= last) throw new Error(`the recording ends at ${clock(last * step_s)}, before the video begins`);
    // The last ten seconds, if fewer are left.
    const isLate = Number.isNaN(to) && position + DEFAULT_S / step_s > last;
    const start = inside(Number.isNaN(from) ? (isLate ? last - DEFAULT_S / step_s : position) : from);
    if (to <= start) throw new Error(`the video would end at ${clock(to * step_s)}, before it begins at ${clock(start * step_s)}`);
    return [start, inside(Number.isNaN(to) ? start + DEFAULT_S / step_s : to)];
  }

  private async film(): Promise<void> {
    const filmed = this.filmed();
    if (!filmed) return;
    const {playback} = filmed;
    const {position, playing} = playback;
    playback.playing = false;
    this.isStopped = false;
    this.setFilming(true);
    try {
      const blob = await this.encode(filmed);
      if (blob) this.save(`${filmed.name}.webm`, blob);
    } catch (error) {
      this.failed(error as Error);
    }
    this.setFilming(false);
    this.stage.endFilm();
    playback.seek(position);
    playback.playing = playing;
    setText(el('videoButton'), 'Save video');
  }

  /** While a film is made, only its button can be used: everything else would change the film. */
  private setFilming(isFilming: boolean): void {
    this.isFilming = isFilming;
    const others = document.querySelectorAll<HTMLElement>('.bar, #timeline, #card, #tabs, #viewPane > :not(#videoBox)');
    for (const other of others) other.inert = isFilming;
    document.documentElement.classList.toggle('filming', isFilming);
  }

  /** Returns null if the reader stops. */
  private async encode({playback, show}: Filmed): Promise<Blob | null> {
    const [from, to] = this.span(playback);
    const step = playback.speed / FPS / playback.step_s;
    const count = Math.max(1, Math.round((to - from) / step));
    const height = Number(el<HTMLSelectElement>('videoSize').value);
    const picture = document.createElement('canvas');
    picture.height = height;
    picture.width = (height * 16) / 9;
    const video = await Video.open(picture.width, picture.height);
    try {
      const begin = async (i: number): Promise<void> => {
        await show(from + i * step);
        this.stage.film(picture.width, picture.height);
      };
      await begin(0);
      for (let i = 0; i < count && !this.isStopped; ++i) {
        if (i % PROGRESS_PICTURES === 0) setText(el('videoButton'), `Stop (${Math.floor((100 * i) / count)} %)`);
        this.stage.read(picture);
        writeTime(picture, clock(playback.time_s));
        // The next picture is drawn while this one is encoded.
        if (i + 1 < count) await begin(i + 1);
        await video.add(picture);
      }
      return this.isStopped ? null : await video.finish();
    } finally {
      video.close();
    }
  }
}

/** Writes the simulated time into the lower left corner, legible on any ground. */
function writeTime(picture: HTMLCanvasElement, text: string): void {
  const context = picture.getContext('2d')!;
  const size = TEXT_SHARE * picture.height;
  context.font = `600 ${size}px ${getComputedStyle(document.body).fontFamily}`;
  context.lineWidth = size / 6;
  context.lineJoin = 'round';
  context.strokeStyle = 'rgba(16, 22, 32, 0.75)';
  context.fillStyle = '#fff';
  context.strokeText(text, size, picture.height - size);
  context.fillText(text, size, picture.height - size);
}
