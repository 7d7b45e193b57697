// DistanceLines draws lines between a body and the nearest others over the picture, with their distances.
// Invariant: a line ends at the closest points; where these are unknown, at the middle of the closest parts.
import {Vector3, type Matrix4} from 'three';
import {boxOf} from './bodies.ts';
import {distanceText} from './proximity.ts';
import {centreOf} from './picking.ts';
import type {Frame, ProximityRow, Run} from './protocol.ts';

const UP = new Vector3(0, 0, 1);
const LABEL_PX = 16;
const MARGIN_PX = 5;
const DOT_PX = 2.5;

interface Line {
  from: [number, number];
  to: [number, number];
  text: string;
}

export class DistanceLines {
  body = -1;
  rows: ProximityRow[] = [];
  private lines: Line[] = [];

  /** Number of lines in the picture. */
  get shown(): number {
    return this.lines.length;
  }

  /** Projects the lines with the product of projection and view. */
  place(run: Run, frame: Frame | null, matrix: Matrix4, width: number, height: number): void {
    this.lines = [];
    if (!frame || this.body >= frame.avatars) return;
    const e = matrix.elements;
    const pixel = ({x, y, z}: Vector3): [number, number] | null => {
      const w = e[3] * x + e[7] * y + e[11] * z + e[15];
      if (w <= 0) return null;
      const across = (e[0] * x + e[4] * y + e[8] * z + e[12]) / w;
      const up = (e[1] * x + e[5] * y + e[9] * z + e[13]) / w;
      return [(0.5 + 0.5 * across) * width, (0.5 - 0.5 * up) * height];
    };
    for (const near of this.rows) {
      const [from, to] = endsOf(run, frame, this.body, near).map(pixel);
      if (from && to) this.lines.push({from, to, text: distanceText(near)});
    }
  }

  draw(context: CanvasRenderingContext2D): void {
    context.lineCap = 'round';
    // A light line on a dark one is visible on any ground.
    for (const [style, width] of [['rgba(16, 22, 32, 0.75)', 4], ['#ffd54a', 2]] as const) {
      context.strokeStyle = context.fillStyle = style;
      context.lineWidth = width;
      context.beginPath();
      for (const {from, to} of this.lines) {
        context.moveTo(...from);
        context.lineTo(...to);
      }
      context.stroke();
      context.beginPath();
      for (const {from, to} of this.lines)
        for (const [x, y] of [from, to]) {
          context.moveTo(x + DOT_PX + width / 2, y);
          context.arc(x, y, DOT_PX + width / 2 - 1, 0, 2 * Math.PI);
        }
      context.fill();
    }
  }

  /** Writes the distances, of which none covers another. */
  label(context: CanvasRenderingContext2D): void {
    context.font = "13px 'Source Sans 3', sans-serif";
    context.textBaseline = 'middle';
    const taken: [number, number, number][] = []; // left, right, middle
    for (const {from, to, text} of this.lines) {
      const width = context.measureText(text).width + 2 * MARGIN_PX;
      const left = (from[0] + to[0] - width) / 2;
      let y = (from[1] + to[1]) / 2 - LABEL_PX;
      const covers = ([l, r, m]: [number, number, number]): boolean =>
        left < r && left + width > l && Math.abs(y - m) < LABEL_PX;
      while (taken.some(covers)) y -= LABEL_PX / 2;
      taken.push([left, left + width, y]);
      context.fillStyle = 'rgba(16, 22, 32, 0.85)';
      context.beginPath();
      context.roundRect(left, y - LABEL_PX / 2, width, LABEL_PX, 5);
      context.fill();
      context.fillStyle = '#fff';
      context.fillText(text, left + MARGIN_PX, y + 0.5);
    }
    context.textBaseline = 'alphabetic';
  }
}

/** Returns the ends of a line on the body and on the other one. */
export function endsOf(run: Run, frame: Frame, body: number, near: ProximityRow): [Vector3, Vector3] {
  if (near.points) return [new Vector3(...near.points[0]), new Vector3(...near.points[1])];
  const own = centreOf(run, frame, body, near.part);
  const isObstacle = near.other >= run.avatars;
  return [own, isObstacle ? nearestOfBox(run, near.other, own) : centreOf(run, frame, near.other, near.otherPart)];
}

/** Returns the point of an obstacle's box that is nearest to a point. */
function nearestOfBox(run: Run, body: number, point: Vector3): Vector3 {
  const obstacle = run.obstacles[body - run.avatars];
  const box = boxOf(obstacle.mesh);
  const place = new Vector3(...obstacle.centre_m);
  const [centre, half] = [new Vector3(...box.centre_m), new Vector3(...box.half_m)];
  const inside = point.clone().sub(place).applyAxisAngle(UP, -obstacle.heading_rad);
  inside.clamp(centre.clone().sub(half), centre.clone().add(half));
  return inside.applyAxisAngle(UP, obstacle.heading_rad).add(place);
}
