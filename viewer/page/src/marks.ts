// Marks draws a circle over the picture for each touching pair, also where bodies or walls hide it.
// Invariant: circles have the same size on the screen at any distance.
import {Matrix4, Quaternion, Vector3, type Camera} from 'three';
import {Grid} from './cells.ts';
import type {Bodies} from './filter.ts';
import {DistanceLines} from './distance_lines.ts';
import {heightOf} from './framing.ts';
import {centreOf, type PartPose} from './picking.ts';
import {PAIR_WORDS, WHOLE_BODY, type Frame, type Run} from './protocol.ts';
import {MARKS} from './theme.ts';

const DIAMETER_PX = 9;
const SELECTED_PX = 13;
const RING_PX = 1.5;
const HAIRLINE_PX = 0.75;
/** Marks that had to move further than this have a line to their point. */
const LEADER_PX = 8;
/** People of less height have their marks at the chest: a mark hides them, and part poses cost much. */
const FAR_PX = 1.5 * DIAMETER_PX;
/** More marks than this stay where they are: they fill the picture. */
const MAX_SPREAD = 3000;
const MAX_ROUNDS = 40;
/** Rounds times marks, which bounds the time. */
const MAX_STEPS = 15_000;
const ENOUGH_PX = 0.4;
/** Needs fewer rounds than 1; with 1.6, dense marks do not come to rest. */
const OVER_RELAXATION = 1.3;
const GOLDEN_RAD = 2.399963;

/**
 * Returns positions (x, y) near `points` where circles of the given radii hardly overlap. Equal arguments give equal
 * results; circles that overlap none stay.
 */
export function spread(points: Float32Array, radii: Float32Array, count = radii.length): Float32Array<ArrayBuffer> {
  const at = points.slice(0, 2 * count);
  const rounds = count > MAX_SPREAD ? 0 : Math.min(MAX_ROUNDS, Math.floor(MAX_STEPS / Math.max(1, count)));
  let reach = 1;
  for (let i = 0; i < count; ++i) reach = Math.max(reach, 2 * radii[i]);
  for (let round = 0; round < rounds && separate(at, radii, new Grid(at, 2, count, reach)) > ENOUGH_PX; ++round);
  return at;
}

/** Pushes each pair of overlapping circles apart; returns the largest overlap found. */
function separate(at: Float32Array, radii: Float32Array, grid: Grid): number {
  let worst = 0;
  grid.eachPair((i, j) => {
    const overlap = push(at, i, j, radii[i] + radii[j]);
    if (overlap > worst) worst = overlap;
  });
  return worst;
}

/** Moves both circles by a little more than half of their overlap; returns the overlap. */
function push(at: Float32Array, i: number, j: number, apart: number): number {
  let dx = at[2 * i] - at[2 * j];
  let dy = at[2 * i + 1] - at[2 * j + 1];
  if (Math.abs(dx) >= apart || Math.abs(dy) >= apart) return 0;
  let away = Math.sqrt(dx * dx + dy * dy);
  if (away >= apart) return 0;
  const overlap = apart - away;
  if (away < 1e-3) {
    dx = Math.cos(i * GOLDEN_RAD);
    dy = Math.sin(i * GOLDEN_RAD);
    away = 1;
  }
  const half = (OVER_RELAXATION * overlap) / (2 * away);
  at[2 * i] += half * dx;
  at[2 * i + 1] += half * dy;
  at[2 * j] -= half * dx;
  at[2 * j + 1] -= half * dy;
  return overlap;
}

/** Returns the parts of a contact as in the words of a frame. */
const partsOf = ({partA, partB}: Bodies): number => partA | (partB << 8);

export class Marks {
  /** Whether a pair, by its index in the frame, has a mark. */
  accepts: (frame: Frame, pair: number) => boolean = () => true;
  /** The contact whose mark alone is large; null: those of the selected bodies. */
  contact: Bodies | null = null;
  readonly distances = new DistanceLines();
  readonly canvas = document.createElement('canvas');
  private readonly context = this.canvas.getContext('2d')!;
  private readonly sprites = new Map<number, HTMLCanvasElement>();
  private ratio = 0;
  private count = 0;
  private pairs = new Uint32Array(64);
  private levels = new Uint8Array(64); // twice the level, plus one if selected
  private radii = new Float32Array(64);
  private points = new Float32Array(128);
  private placed = new Float32Array(0);
  private readonly matrix = new Matrix4();
  private readonly pose: PartPose = {origin: new Vector3(), rotation: new Quaternion()};
  private readonly centre = new Vector3();
  private readonly other = new Vector3();

  constructor(stage: HTMLCanvasElement) {
    this.canvas.id = 'marks';
    this.canvas.setAttribute('aria-hidden', 'true');
    const size = {inset: '0', width: '100%', height: '100%'};
    Object.assign(this.canvas.style, {...size, position: 'fixed', pointerEvents: 'none'});
    stage.after(this.canvas);
  }

  /** `ratio`: pixels of the picture for each unit of width and height. */
  resize(width: number, height: number, ratio = Math.min(window.devicePixelRatio || 1, 2)): void {
    if (ratio !== this.ratio) this.sprites.clear();
    this.ratio = ratio;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.count = 0;
  }

  /** Draws the marks of a frame; without one, removes them. */
  draw(run: Run, frame: Frame | null, camera: Camera, selected: readonly number[]): void {
    const wasEmpty = this.count === 0 && this.distances.shown === 0;
    this.count = 0;
    if (frame) this.collect(run, frame, camera, selected);
    this.distances.place(run, frame, this.matrix, this.canvas.width / this.ratio, this.canvas.height / this.ratio);
    if (wasEmpty && this.count === 0 && this.distances.shown === 0) return;
    this.placed = spread(this.points, this.radii, this.count);
    this.context.setTransform(1, 0, 0, 1, 0, 0);
    this.context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.paint(this.context, this.canvas.width);
  }

  /** Paints what was drawn last, over a picture of this width in pixels. */
  paint(context: CanvasRenderingContext2D, width: number): void {
    const scale = (this.ratio * width) / this.canvas.width;
    context.setTransform(scale, 0, 0, scale, 0, 0);
    this.distances.draw(context);
    this.drawLeaders(context);
    for (const isSelected of [0, 1])
      for (let i = 0; i < this.count; ++i) if ((this.levels[i] & 1) === isSelected) this.stamp(context, i);
    this.distances.label(context);
    context.setTransform(1, 0, 0, 1, 0, 0);
  }

  /** Returns the index of the pair whose mark lies under a pixel, or -1. */
  at(x: number, y: number): number {
    for (let i = this.count - 1; i >= 0; --i)
      if (Math.hypot(x - this.placed[2 * i], y - this.placed[2 * i + 1]) <= this.radii[i]) return this.pairs[i];
    return -1;
  }

  /** Number of marks in the picture. */
  get shown(): number {
    return this.count;
  }

  private collect(run: Run, frame: Frame, camera: Camera, selected: readonly number[]): void {
    const e = this.matrix.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).elements;
    const width = this.canvas.width / this.ratio;
    const height = this.canvas.height / this.ratio;
    const metre_px = 0.5 * height * camera.projectionMatrix.elements[5]; // one metre ahead
    this.reserve(frame.pairs);
    for (let pair = 0; pair < frame.pairs; ++pair) {
      if (!this.accepts(frame, pair)) continue;
      const {x, y, z} = this.middleOf(run, frame, pair, metre_px / FAR_PX);
      const w = e[3] * x + e[7] * y + e[11] * z + e[15];
      if (w <= 0) continue;
      const across = (0.5 + (0.5 * (e[0] * x + e[4] * y + e[8] * z + e[12])) / w) * width;
      const down = (0.5 - (0.5 * (e[1] * x + e[5] * y + e[9] * z + e[13])) / w) * height;
      if (!(across >= 0 && across <= width && down >= 0 && down <= height)) continue;
      this.points[2 * this.count] = across;
      this.points[2 * this.count + 1] = down;
      this.note(pair, (frame.pairWords[PAIR_WORDS * pair + 2] >>> 16) & 0xff, this.isSelected(frame, pair, selected));
    }
  }

  private note(pair: number, level: number, isSelected: boolean): void {
    this.pairs[this.count] = pair;
    this.levels[this.count] = 2 * level + (isSelected ? 1 : 0);
    this.radii[this.count] = (isSelected ? SELECTED_PX : DIAMETER_PX) / 2 + RING_PX;
    ++this.count;
  }

  private reserve(count: number): void {
    if (count <= this.pairs.length) return;
    const size = 2 * count;
    this.pairs = new Uint32Array(size);
    this.levels = new Uint8Array(size);
    this.radii = new Float32Array(size);
    this.points = new Float32Array(2 * size);
  }

  /**
   * Returns the middle between the two parts; that of the person's part at an obstacle. A person of one metre is far
   * from `far_m` on.
   */
  private middleOf(run: Run, frame: Frame, pair: number, far_m: number): Vector3 {
    const words = frame.pairWords;
    const at = PAIR_WORDS * pair;
    const [a, b, rest] = [words[at], words[at + 1], words[at + 2]];
    const person = a < run.avatars ? a : b;
    const isFar = this.depthOf(frame, person) > heightOf(run, person) * far_m;
    const [partA, partB] = isFar ? [WHOLE_BODY, WHOLE_BODY] : [rest & 0xff, (rest >>> 8) & 0xff];
    if (a >= run.avatars) return centreOf(run, frame, b, partB, this.centre, this.pose);
    centreOf(run, frame, a, partA, this.centre, this.pose);
    if (b >= run.avatars) return this.centre;
    return this.centre.lerp(centreOf(run, frame, b, partB, this.other, this.pose), 0.5);
  }

  /** Returns the distance of a person along the view, in metres. */
  private depthOf({positions}: Frame, id: number): number {
    const e = this.matrix.elements;
    return e[3] * positions[4 * id] + e[7] * positions[4 * id + 1] + e[11] * positions[4 * id + 2] + e[15];
  }

  private isSelected(frame: Frame, pair: number, selected: readonly number[]): boolean {
    const at = PAIR_WORDS * pair;
    const [a, b, rest] = [frame.pairWords[at], frame.pairWords[at + 1], frame.pairWords[at + 2]];
    const {contact} = this;
    if (contact) return a === contact.a && b === contact.b && (rest & 0xffff) === partsOf(contact);
    if (selected.length < 2) return selected.length === 1 && (a === selected[0] || b === selected[0]);
    return selected.includes(a) && selected.includes(b);
  }

  private drawLeaders(context: CanvasRenderingContext2D): void {
    const {points, placed} = this;
    context.beginPath();
    for (let i = 0; i < 2 * this.count; i += 2) {
      if (Math.hypot(placed[i] - points[i], placed[i + 1] - points[i + 1]) <= LEADER_PX) continue;
      context.moveTo(points[i], points[i + 1]);
      context.lineTo(placed[i], placed[i + 1]);
    }
    // A light line on a dark one is visible on any ground.
    for (const [style, width] of [['rgba(16, 22, 32, 0.55)', 1.75], ['rgba(255, 255, 255, 0.9)', 0.75]] as const) {
      context.strokeStyle = style;
      context.lineWidth = width;
      context.stroke();
    }
  }

  private stamp(context: CanvasRenderingContext2D, i: number): void {
    const sprite = this.spriteOf(this.levels[i]);
    const size = sprite.width / this.ratio;
    context.drawImage(sprite, this.placed[2 * i] - size / 2, this.placed[2 * i + 1] - size / 2, size, size);
  }

  /** Returns the picture of a mark; stamping it is faster than drawing arcs. */
  private spriteOf(kind: number): HTMLCanvasElement {
    const known = this.sprites.get(kind);
    if (known) return known;
    const isSelected = (kind & 1) === 1;
    const radius = (isSelected ? SELECTED_PX : DIAMETER_PX) / 2;
    const hairline = isSelected ? RING_PX : HAIRLINE_PX;
    const sprite = document.createElement('canvas');
    sprite.width = sprite.height = Math.ceil(2 * this.ratio * (radius + RING_PX + hairline + 1));
    const context = sprite.getContext('2d')!;
    context.scale(this.ratio, this.ratio);
    const middle = sprite.width / this.ratio / 2;
    const disc = (size: number, style: string): void => {
      context.fillStyle = style;
      context.beginPath();
      context.arc(middle, middle, size, 0, 2 * Math.PI);
      context.fill();
    };
    disc(radius + RING_PX + hairline, 'rgba(16, 22, 32, 0.85)');
    disc(radius + RING_PX, '#fff');
    disc(radius, MARKS[(kind >> 1) + 1].color);
    this.sprites.set(kind, sprite);
    return sprite;
  }
}
