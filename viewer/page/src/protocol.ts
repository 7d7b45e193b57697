// Decodes the binary messages of the server into typed arrays over the received bytes.
// Invariant: frame data is neither copied nor converted; it goes to the graphics card unchanged.

import type {Motion} from './motion.ts';

const RUN_MESSAGE = 0x31525454;
const FRAME_MESSAGE = 0x31465454;
const CONTACTS_MESSAGE = 0x31435454;
const PROXIMITY_MESSAGE = 0x31445454;
const POSITIONS_MESSAGE = 0x31505454;
const POSITIONS_HEAD_BYTES = 32;
const HEAD_BYTES = 64;
const CONTACTS_HEAD_BYTES = 32;
const CHANGE_WORDS = 7;
const PROXIMITY_HEAD_BYTES = 32;
const PROXIMITY_WORDS = 5;

export const AVATAR_WORDS = 4;
export const PART_WORDS = 4;
export const PAIR_WORDS = 4;

/** Part index of a pair of whole bodies that was not refined to parts. */
export const WHOLE_BODY = 255;

export type Vec3 = [number, number, number];

export interface Mesh {
  positions: Float32Array; // x, y, z in metres, in the frame of the part or obstacle
  indices: Uint32Array; // triangles, or the lines of a hull
}

export interface Box {
  centre_m: Vec3;
  half_m: Vec3;
}

export interface Part {
  name: string;
  link: number;
  box: Box;
  mesh: Mesh;
  hull: Mesh;
}

export interface Joint {
  name: string;
  kind: number; // 0 fixed, 1 and 2 turn, 3 slides
  parent_link: number;
  position_m: Vec3;
  rotation_wxyz: [number, number, number, number];
  axis: Vec3;
  mimic_joint: number;
  mimic_multiplier: number;
  mimic_offset: number;
  column: number;
}

export interface Model {
  name: string;
  is_person: boolean;
  height_m: number;
  sphere: {centre_z_m: number; radius_m: number};
  part_step_m: number;
  parts: Part[];
  joints: Joint[];
}

export interface Obstacle {
  name: string;
  kind: number;
  centre_m: Vec3;
  heading_rad: number;
  mesh: Mesh;
}

export interface Run {
  mode: 'live' | 'log' | 'file';
  scene: string;
  seed: number;
  run_id: string;
  step_s: number;
  part_volume: string;
  hull_directions: number;
  exact: boolean;
  /** `floor`: polygons of the walkable part, each an outline and its holes; none: all of it. */
  ground: {min_m: [number, number]; max_m: [number, number]; floor: [number, number][][][]};
  avatars: number;
  models: Model[];
  obstacles: Obstacle[];
  groups: string[];
  scaleOfAvatar: Float32Array;
  modelOfAvatar: Int16Array;
  groupOfAvatar: Int16Array;
  firstPart: Uint32Array; // avatars + 1 entries
}

export interface Frame {
  number: number;
  time_s: number;
  seq: number;
  frame_ms: number;
  build_ms: number;
  crowded: number;
  present: number;
  lost: number;
  avatars: number;
  pairs: number;
  people: Uint32Array; // one texel per person: x, y, z as floats, then flags, mark and speed
  positions: Float32Array; // the same bytes
  parts: Uint32Array; // one texel per part; of a frame with motion, only those that motion.fillPart() has filled
  pairWords: Uint32Array; // a, b, part_a | part_b << 8 | level << 16, then the frame of the begin
  /** Computes parts on request; frames of a server have none. */
  motion?: Motion;
}

interface MeshPlace {
  vertex_step_m: number;
  vertices: number;
  vertex_count: number;
  indices: number;
  index_count: number;
}

function meshAt(place: MeshPlace, buffer: ArrayBuffer, base: number): Mesh {
  const steps = new Int16Array(buffer, base + place.vertices, place.vertex_count * 3);
  const positions = new Float32Array(steps.length);
  for (let i = 0; i < steps.length; ++i) positions[i] = steps[i] * place.vertex_step_m;
  return {positions, indices: new Uint32Array(buffer, base + place.indices, place.index_count)};
}

/** Returns the kind of a binary message; '' for unknown ones. */
export function kindOf(buffer: ArrayBuffer): 'run' | 'frame' | 'contacts' | 'proximity' | 'positions' | '' {
  if (buffer.byteLength < 8) return '';
  switch (new DataView(buffer).getUint32(0, true)) {
    case RUN_MESSAGE:
      return 'run';
    case FRAME_MESSAGE:
      return 'frame';
    case CONTACTS_MESSAGE:
      return 'contacts';
    case PROXIMITY_MESSAGE:
      return 'proximity';
    case POSITIONS_MESSAGE:
      return 'positions';
    default:
      return '';
  }
}

/** Throws a RangeError or SyntaxError if the bytes are no run message. */
export function decodeRun(buffer: ArrayBuffer): Run {
  if (kindOf(buffer) !== 'run') throw new RangeError('not a run message');
  const textBytes = new DataView(buffer).getUint32(4, true);
  const text = new TextDecoder().decode(new Uint8Array(buffer, 8, textBytes));
  const base = 8 + textBytes;
  const json = JSON.parse(text);
  for (const model of json.models)
    for (const part of model.parts) {
      part.mesh = meshAt(part.mesh, buffer, base);
      part.hull = meshAt(part.hull, buffer, base);
    }
  for (const obstacle of json.obstacles) obstacle.mesh = meshAt(obstacle.mesh, buffer, base);
  const run: Run = {
    ...json,
    scaleOfAvatar: new Float32Array(buffer, base + json.scale_of_avatar, json.avatars),
    modelOfAvatar: new Int16Array(buffer, base + json.model_of_avatar, json.avatars),
    groupOfAvatar: new Int16Array(buffer, base + json.group_of_avatar, json.avatars),
    firstPart: new Uint32Array(json.avatars + 1),
  };
  for (let i = 0; i < run.avatars; ++i)
    run.firstPart[i + 1] = run.firstPart[i] + run.models[run.modelOfAvatar[i]].parts.length;
  return run;
}

/** Returns views into `buffer`; throws a RangeError if its length contradicts its head. */
export function decodeFrame(buffer: ArrayBuffer): Frame {
  if (kindOf(buffer) !== 'frame') throw new RangeError('not a frame message');
  const head = new DataView(buffer, 0, HEAD_BYTES);
  const avatars = head.getUint32(4, true);
  const parts = head.getUint32(8, true);
  const pairs = head.getUint32(12, true);
  const partsAt = HEAD_BYTES + avatars * 16;
  const pairsAt = partsAt + parts * 16;
  if (pairsAt + pairs * 4 * PAIR_WORDS !== buffer.byteLength) throw new RangeError('frame message has a wrong length');
  return {
    number: head.getFloat64(16, true),
    time_s: head.getFloat64(24, true),
    seq: head.getFloat64(32, true),
    frame_ms: head.getFloat32(40, true),
    build_ms: head.getFloat32(44, true),
    crowded: head.getUint32(48, true),
    present: head.getUint32(52, true),
    lost: head.getFloat32(56, true),
    avatars,
    pairs,
    people: new Uint32Array(buffer, HEAD_BYTES, avatars * AVATAR_WORDS),
    positions: new Float32Array(buffer, HEAD_BYTES, avatars * AVATAR_WORDS),
    parts: new Uint32Array(buffer, partsAt, parts * PART_WORDS),
    pairWords: new Uint32Array(buffer, pairsAt, pairs * PAIR_WORDS),
  };
}

/** A begin or end of a contact of two parts. */
export interface ContactChange {
  kind: 'began' | 'ended' | 'lost';
  frame: number;
  /** Frame of the begin; ~f if it is only known to be before frame f. */
  began: number;
  a: number;
  b: number;
  partA: number;
  partB: number;
  /** The middle between both people; NaN: unknown. At an obstacle, the place of the person. */
  x_m: number;
  y_m: number;
}

export interface ContactChanges {
  /** Number of the first change since the run began, and of the one after the newest. */
  first: number;
  known: number;
  /** The newest frame that the changes cover; -1: none. */
  frame: number;
  changes: ContactChange[];
}

const CHANGE_KINDS = ['began', 'ended', 'lost'] as const;

/** Throws a RangeError if the length contradicts the head. */
export function decodeContacts(buffer: ArrayBuffer): ContactChanges {
  if (kindOf(buffer) !== 'contacts') throw new RangeError('not a contacts message');
  const head = new DataView(buffer, 0, CONTACTS_HEAD_BYTES);
  const count = head.getUint32(4, true);
  const words = new Int32Array(buffer, CONTACTS_HEAD_BYTES);
  const floats = new Float32Array(buffer, CONTACTS_HEAD_BYTES);
  if (words.length !== count * CHANGE_WORDS) throw new RangeError('contacts message has a wrong length');
  const changes = Array.from({length: count}, (_, i): ContactChange => {
    const at = i * CHANGE_WORDS;
    const [frame, began, a, b, rest] = words.subarray(at, at + 5);
    const kind = CHANGE_KINDS[(rest >>> 16) & 0xff] ?? 'lost';
    return {kind, frame, began, a, b, partA: rest & 0xff, partB: (rest >>> 8) & 0xff, x_m: floats[at + 5], y_m: floats[at + 6]};
  });
  return {first: head.getFloat64(8, true), known: head.getFloat64(16, true), frame: head.getFloat64(24, true), changes};
}

/** The nearest parts of a body and another one in a frame. */
export interface ProximityRow {
  frame: number;
  other: number;
  part: number;
  otherPart: number;
  level: number;
  /** Bounds of the distance. */
  lo_m: number;
  hi_m: number;
  /** The closest points of the body and the other one; null: unknown. */
  points: [Vec3, Vec3] | null;
}

export interface ProximityRows {
  body: number;
  /** Whether the run has proximity rows so far. */
  isRecorded: boolean;
  /** The rows cover frames from <= frame < to, in their order. */
  from: number;
  to: number;
  rows: ProximityRow[];
}

/** Throws a RangeError if the length contradicts the head. */
export function decodeProximity(buffer: ArrayBuffer): ProximityRows {
  if (kindOf(buffer) !== 'proximity') throw new RangeError('not a proximity message');
  const view = new DataView(buffer);
  const count = view.getUint32(4, true);
  const pointsAt = Math.ceil((PROXIMITY_HEAD_BYTES + 4 * PROXIMITY_WORDS * count) / 8) * 8;
  if (pointsAt > buffer.byteLength) throw new RangeError('proximity message has a wrong length');
  const coordinates = new Float64Array(buffer, pointsAt);
  let next = 0;
  const point = (): Vec3 => [coordinates[next++], coordinates[next++], coordinates[next++]];
  const rows = Array.from({length: count}, (_, i): ProximityRow => {
    const at = PROXIMITY_HEAD_BYTES + 4 * PROXIMITY_WORDS * i;
    return {
      frame: view.getInt32(at, true),
      other: view.getUint32(at + 4, true),
      part: view.getUint8(at + 8),
      otherPart: view.getUint8(at + 9),
      level: view.getUint8(at + 10),
      lo_m: view.getFloat32(at + 12, true),
      hi_m: view.getFloat32(at + 16, true),
      points: view.getUint8(at + 11) === 1 ? [point(), point()] : null,
    };
  });
  if (next !== coordinates.length) throw new RangeError('proximity message has a wrong length');
  const [body, recorded] = [view.getUint32(8, true), view.getUint32(12, true)];
  return {body, isRecorded: recorded === 1, from: view.getFloat64(16, true), to: view.getFloat64(24, true), rows};
}

export interface Positions {
  samples: number;
  /** The samples are those of from <= frame < to. */
  from: number;
  to: number;
  /** x, y of each avatar for each sample; NaN: not present. */
  places: Float32Array;
}

/** Throws a RangeError if the length contradicts the head. */
export function decodePositions(buffer: ArrayBuffer): Positions {
  if (kindOf(buffer) !== 'positions') throw new RangeError('not a positions message');
  const head = new DataView(buffer, 0, POSITIONS_HEAD_BYTES);
  const [samples, avatars] = [head.getUint32(4, true), head.getUint32(8, true)];
  const places = new Float32Array(buffer, POSITIONS_HEAD_BYTES);
  if (places.length !== 2 * samples * avatars) throw new RangeError('positions message has a wrong length');
  return {samples, from: head.getFloat64(16, true), to: head.getFloat64(24, true), places};
}

/** A robot that was too close to a person: begin, the frame after the last or -1, robot, person, region, lack in metres. */
export type Shortfall = [number, number, number, number, string, number];

export interface Person {
  present: boolean;
  crowded: boolean;
  mark: number;
  speed_mps: number;
  position_m: Vec3;
}

export function isPresent(frame: Frame, id: number): boolean {
  return (frame.people[id * AVATAR_WORDS + 3] & 1) !== 0;
}

export function personOf(frame: Frame, id: number): Person {
  const at = id * AVATAR_WORDS;
  const state = frame.people[at + 3];
  return {
    present: (state & 1) !== 0,
    crowded: (state & 2) !== 0,
    mark: (state >>> 8) & 0xff,
    speed_mps: (state >>> 16) / 1000,
    position_m: [frame.positions[at], frame.positions[at + 1], frame.positions[at + 2]],
  };
}

export interface Pair {
  a: number;
  b: number;
  partA: number;
  partB: number;
  level: number;
  /** The frame in which the contact began; ~f if it is only known to be before frame f. */
  began: number;
}

export function pairAt(frame: Frame, index: number): Pair {
  const at = index * PAIR_WORDS;
  const rest = frame.pairWords[at + 2];
  return {
    a: frame.pairWords[at],
    b: frame.pairWords[at + 1],
    partA: rest & 0xff,
    partB: (rest >>> 8) & 0xff,
    level: (rest >>> 16) & 0xff,
    began: frame.pairWords[at + 3] | 0,
  };
}

/** Returns the pairs of a body; pairs are sorted by a, then b. */
export function pairsOf(frame: Frame, id: number): Pair[] {
  const found: Pair[] = [];
  const words = frame.pairWords;
  for (let at = 0; at < words.length; at += PAIR_WORDS)
    if (words[at] === id || words[at + 1] === id) found.push(pairAt(frame, at / PAIR_WORDS));
  return found;
}

/** Splits a name into words: "leftHand" becomes "left hand". Equals display_name() of base/text.h. */
export function displayName(name: string): string {
  const words = name
    .replace(/([a-z0-9])([A-Z])/g, '$1 $2')
    .replace(/([A-Z])([A-Z][a-z])/g, '$1 $2')
    .replace(/[_ ]+/g, ' ')
    .replace(/[A-Z]/g, (capital) => capital.toLowerCase())
    .replace(/^ | $/g, '');
  return words || name;
}

export function isPerson(run: Run, body: number): boolean {
  return body < run.avatars && run.models[run.modelOfAvatar[body]].is_person;
}

export function nameOf(run: Run, body: number): string {
  if (body < run.avatars) return `${run.groups[run.groupOfAvatar[body]] ?? 'person'} ${body}`;
  return run.obstacles[body - run.avatars]?.name ?? `obstacle ${body}`;
}

export function partNameOf(run: Run, body: number, part: number): string {
  if (part === WHOLE_BODY) return 'body';
  if (body >= run.avatars) return '';
  return displayName(run.models[run.modelOfAvatar[body]].parts[part]?.name ?? `part ${part}`);
}
