// The floor map colours cells of the ground by contacts or density. Invariant: counts sum to the placed contacts.
import {DataTexture, Mesh, NearestFilter, PlaneGeometry, SRGBColorSpace, type RawShaderMaterial} from 'three';
import {scaleColor} from './coloring.ts';
import type {Contact} from './contacts.ts';
import type {Run} from './protocol.ts';
import {shaderMaterial} from './shaders.ts';

export interface FloorGrid {
  columns: number;
  rows: number;
  min_m: [number, number];
  cell_m: number;
}

export interface HeatCells extends FloorGrid {
  counts: Uint32Array | Float32Array; // row by row from the south-west
  /** The highest count. */
  most: number;
}

const MIN_CELL_M = 0.5;
const MAX_CELLS = 256; // per side

/** Returns cells that cover the ground, of at least this length. */
export function gridOf(run: Run, minCell_m = MIN_CELL_M): FloorGrid {
  const {min_m, max_m} = run.ground;
  const size = [max_m[0] - min_m[0], max_m[1] - min_m[1]];
  const cell_m = Math.max(minCell_m, Math.max(...size) / MAX_CELLS);
  const [columns, rows] = size.map((length) => Math.max(1, Math.ceil(length / cell_m)));
  return {columns, rows, min_m, cell_m};
}

/** Returns the index of the cell at a place; of the nearest one for places off the ground. */
export function cellOf({columns, rows, min_m, cell_m}: FloorGrid, x_m: number, y_m: number): number {
  const cell = (at: number, axis: number, most: number): number =>
    Math.min(most - 1, Math.max(0, Math.floor((at - min_m[axis]) / cell_m)));
  return cell(y_m, 1, rows) * columns + cell(x_m, 0, columns);
}

/** Returns the value of the cell at a place; null off the cells. */
export function valueAt(cells: HeatCells, x_m: number, y_m: number): number | null {
  const [across, up] = [(x_m - cells.min_m[0]) / cells.cell_m, (y_m - cells.min_m[1]) / cells.cell_m];
  const isInside = across >= 0 && up >= 0 && across < cells.columns && up < cells.rows;
  return isInside ? cells.counts[cellOf(cells, x_m, y_m)] : null;
}

/** Counts contacts by their place, where it is known. */
export function heatOf(run: Run, contacts: Iterable<Contact>): HeatCells {
  const grid = gridOf(run);
  const counts = new Uint32Array(grid.columns * grid.rows);
  for (const {x_m, y_m} of contacts) if (!Number.isNaN(x_m)) ++counts[cellOf(grid, x_m, y_m)];
  const most = counts.reduce((max, count) => Math.max(max, count), 0);
  return {...grid, counts, most};
}

const VERTEX = /* glsl */ `
precision highp float;
uniform mat4 modelMatrix;
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
in vec3 position;
in vec2 uv;
out vec2 vCell;
void main() {
  vCell = uv;
  gl_Position = projectionMatrix * viewMatrix * modelMatrix * vec4(position, 1.0);
}`;

const FRAGMENT = /* glsl */ `
precision highp float;
uniform sampler2D uCells;
in vec2 vCell;
out vec4 fragment;
void main() { fragment = texture(uCells, vCell); }`;

/** HeatMap draws the cells slightly above the ground, below the shadows. */
export class HeatMap {
  readonly mesh: Mesh<PlaneGeometry, RawShaderMaterial>;

  constructor() {
    const material = shaderMaterial(VERTEX, FRAGMENT, {uCells: {value: null}});
    material.transparent = true;
    material.depthWrite = false;
    this.mesh = new Mesh(new PlaneGeometry(1, 1), material);
    this.mesh.renderOrder = -0.4; // after the floor
    this.mesh.visible = false;
  }

  /** Shows cells; null hides them. High counts stand out from the ground: dark on light, or light on dark. */
  set(cells: HeatCells | null, isDark: boolean): void {
    this.mesh.visible = cells !== null;
    if (!cells) return;
    const {columns, rows, counts, min_m, cell_m, most} = cells;
    const rgba = new Uint8Array(4 * counts.length);
    for (let i = 0; i < counts.length; ++i) {
      const value = counts[i] / most;
      if (counts[i] > 0) rgba.set([...scaleColor(isDark ? value : 1 - value), 110 + 130 * value], 4 * i);
    }
    const texture = new DataTexture(rgba, columns, rows);
    texture.magFilter = texture.minFilter = NearestFilter;
    texture.colorSpace = SRGBColorSpace;
    texture.needsUpdate = true;
    const uniform = this.mesh.material.uniforms.uCells!;
    uniform.value?.dispose();
    uniform.value = texture;
    this.mesh.scale.set(columns * cell_m, rows * cell_m, 1);
    this.mesh.position.set(min_m[0] + 0.5 * columns * cell_m, min_m[1] + 0.5 * rows * cell_m, 0.002);
  }
}
