// Colours of people by a value: group, speed, density, contacts, distance to a robot.
// The scale grows evenly in lightness: it works in grey and for colour-blind readers.
import {Grid} from './cells.ts';
import type {ContactLog} from './contacts.ts';
import {isPerson, isPresent, personOf, type Frame, type Run} from './protocol.ts';

export type Coloring = '' | 'group' | 'speed' | 'density' | 'contacts' | 'robot';

export const COLORINGS: [Coloring, string][] = [
  ['', 'clothes'],
  ['group', 'group'],
  ['speed', 'speed'],
  ['density', 'density around'],
  ['contacts', 'contacts so far'],
  ['robot', 'distance to a robot'],
];

/** Stops of the viridis scale (van der Walt & Smith, 2015), dark to light. */
const STOPS = [
  [68, 1, 84],
  [59, 82, 139],
  [33, 145, 140],
  [94, 201, 98],
  [253, 231, 37],
] as const;
const MAX_SPEED_MPS = 2;
const MAX_DENSITY = 5;
const DENSITY_RADIUS_M = 1.5;
const MAX_ROBOT_M = 5;

/** Returns the colour of a value from 0 to 1. */
export function scaleColor(value: number): [number, number, number] {
  const at = Math.min(1, Math.max(0, value)) * (STOPS.length - 1);
  const i = Math.min(STOPS.length - 2, Math.floor(at));
  return [0, 1, 2].map((c) => Math.round(STOPS[i][c] + (at - i) * (STOPS[i + 1][c] - STOPS[i][c]))) as [number, number, number];
}

const cssColor = (value: number): string => `rgb(${scaleColor(value).join(' ')})`;

/** Returns the scale as a CSS gradient, from left to right or turned around. */
export function scaleGradient(isTurned = false): string {
  return `linear-gradient(to ${isTurned ? 'left' : 'right'}, ${[0, 0.25, 0.5, 0.75, 1].map(cssColor).join(', ')})`;
}

export interface Legend {
  /** Names and colours of separate values. */
  entries: [string, string][];
  /** Labels of both ends of the scale; empty: there is none. */
  ends: [string, string] | null;
}

interface Values {
  /** From 0 to 1; NaN: the person keeps the clothes. */
  of: Float32Array;
  legend: Legend;
}

/** Returns four bytes per avatar and the legend; null for clothes. */
export function colorsFor(coloring: Coloring, run: Run, frame: Frame, log: ContactLog): {rgba: Uint8Array; legend: Legend} | null {
  if (coloring === '') return null;
  const {of, legend} = VALUES[coloring](run, frame, log);
  const rgba = new Uint8Array(4 * run.avatars);
  for (let id = 0; id < run.avatars; ++id) {
    if (Number.isNaN(of[id])) continue;
    rgba.set(scaleColor(of[id]), 4 * id);
    rgba[4 * id + 3] = 255;
  }
  return {rgba, legend};
}

const VALUES: Record<Exclude<Coloring, ''>, (run: Run, frame: Frame, log: ContactLog) => Values> = {
  group(run) {
    const names = [...new Set(run.groups)];
    const value = (index: number): number => (names.length < 2 ? 0.5 : index / (names.length - 1));
    return {
      of: Float32Array.from(run.groupOfAvatar, (group) => value(names.indexOf(run.groups[group]))),
      legend: {entries: names.map((name, i) => [name, cssColor(value(i))]), ends: null},
    };
  },
  speed(run, frame) {
    return scaled(run, (id) => personOf(frame, id).speed_mps / MAX_SPEED_MPS, ['0 m/s', `${MAX_SPEED_MPS} m/s or more`]);
  },
  density(run, frame) {
    const found = densities(run, frame);
    return scaled(run, (id) => found[id] / MAX_DENSITY, ['0 per m²', `${MAX_DENSITY} per m² or more`]);
  },
  contacts(run, frame, log) {
    const counts = new Float32Array(run.avatars);
    for (const {a, b, begin} of log.ofBodies) {
      if (begin > frame.number) continue;
      ++counts[a];
      if (b < run.avatars) ++counts[b];
    }
    const most = counts.reduce((max, count) => Math.max(max, count), 1);
    return scaled(run, (id) => counts[id] / most, ['none', String(most)]);
  },
  robot(run, frame) {
    const robots: number[] = [];
    for (let id = 0; id < run.avatars; ++id) if (!isPerson(run, id) && isPresent(frame, id)) robots.push(id);
    const away = (id: number): number => {
      if (!isPerson(run, id) || robots.length === 0) return NaN;
      const at = personOf(frame, id).position_m;
      return Math.min(...robots.map((robot) => Math.hypot(at[0] - frame.positions[4 * robot], at[1] - frame.positions[4 * robot + 1])));
    };
    // Near people are light, as are other high values.
    return scaled(run, (id) => 1 - away(id) / MAX_ROBOT_M, [`${MAX_ROBOT_M} m or more`, '0 m']);
  },
};

function scaled(run: Run, value: (id: number) => number, ends: [string, string]): Values {
  const of = new Float32Array(run.avatars);
  for (let id = 0; id < run.avatars; ++id) of[id] = value(id);
  return {of, legend: {entries: [], ends}};
}

/** Returns people per square metre within DENSITY_RADIUS_M of each, itself included. */
function densities(run: Run, frame: Frame): Float32Array {
  const {positions} = frame;
  const out = new Float32Array(run.avatars);
  for (let id = 0; id < run.avatars; ++id) out[id] = isPresent(frame, id) ? 1 : 0;
  new Grid(positions, 4, run.avatars, DENSITY_RADIUS_M, (id) => isPresent(frame, id)).eachPair((i, j) => {
    const [dx, dy] = [positions[4 * i] - positions[4 * j], positions[4 * i + 1] - positions[4 * j + 1]];
    if (dx * dx + dy * dy > DENSITY_RADIUS_M ** 2) return;
    ++out[i];
    ++out[j];
  });
  return out.map((count) => count / (Math.PI * DENSITY_RADIUS_M ** 2));
}
