// ProximityPanel shows how near others come to the selected person or robot: now, and over time.
import {bindBodies, bodyRow} from './card.ts';
import {Chart, type ChartStyle} from './chart.ts';
import {el, make, setText} from './dom.ts';
import {distanceText, type ProximityLog} from './proximity.ts';
import {clock, type Playback} from './playback.ts';
import {isPerson, nameOf, partNameOf, type ProximityRow, type Run} from './protocol.ts';

/** Number of nearest others in the list and in the picture. */
export const MAX_CLOSEST = 5;
const NOT_RECORDED = 'not in this run: throng run --proximity 0.5 records distances';
/** A click reaches the least distance within this many pixels. */
const REACH_PX = 4;

export class ProximityPanel {
  private readonly canvas = el<HTMLCanvasElement>('nearChart');
  private readonly chart: Chart;
  private values: Float32Array = new Float32Array(0);
  private first = 0;
  private least: ProximityRow | null = null;
  private listed = '';

  /**
   * `seek` shows a frame of a recorded run, `show` a distance in it; `resized` is called when update() has to be.
   */
  constructor(
    private readonly seek: (frame: number) => void,
    show: (row: ProximityRow) => void,
    choose: (id: number) => void,
    resized: () => void,
  ) {
    this.chart = new Chart(this.canvas, resized);
    this.canvas.addEventListener('click', (event) => this.seek(this.frameAt(event.offsetX)));
    el('nearLeast').onclick = () => this.least && show(this.least);
    bindBodies('nearPairs', choose);
  }

  /** `playback`: null for a live run, of which the known frames are shown. */
  update(run: Run, log: ProximityLog, frame: number, playback: Playback | null, style: ChartStyle): void {
    // Who selects a robot wants to know how near it came, once it is known whether that was recorded.
    const isMissed = log.to > 0 && log.body >= 0 && !isPerson(run, log.body);
    const isShown = log.body >= 0 && (log.isRecorded || log.note !== '' || isMissed);
    el('near').hidden = !isShown;
    if (!isShown) return;
    this.first = playback ? playback.first : (log.rows[0]?.frame ?? 0);
    const end = playback ? playback.last + 1 : log.to;
    this.values = log.distances(this.first, end);
    const span = end - 1 - this.first;
    const cursor = playback && span > 0 ? (frame - this.first) / span : -1;
    const rows = log.at(frame);
    this.list(run, log, rows);
    this.describe(run, log, frame, playback);
    if (!this.chart.isOld(log.version, log.body, this.first, end, cursor, style)) return;
    this.chart.drawLeast(this.values, (distance_m) => `${distance_m} m`, style, cursor);
  }

  private describe(run: Run, log: ProximityLog, frame: number, playback: Playback | null): void {
    const {canvas} = this;
    const hasRows = log.rows.length > 0;
    canvas.hidden = !hasRows;
    this.least = log.least;
    el('nearLeast').hidden = !hasRows;
    if (!this.least) return;
    const {least} = this;
    setText(el('nearLeast'), `Least: ${distanceText(least)} at ${clock(least.frame * run.step_s)}, ${nameOf(run, least.other)}`);
    el<HTMLButtonElement>('nearLeast').disabled = playback === null;
    const now = this.values[frame - this.first] ?? Infinity;
    const attributes: Record<string, string> = playback
      ? {
          role: 'slider',
          tabindex: '0',
          'aria-valuemin': String(playback.first),
          'aria-valuemax': String(playback.last),
          'aria-valuenow': String(frame),
          'aria-valuetext': `${now < Infinity ? `${now.toFixed(3)} m` : 'nothing near'} at ${clock(frame * run.step_s)}`,
        }
      : {role: 'img'};
    for (const [name, value] of Object.entries(attributes)) canvas.setAttribute(name, value);
  }

  private list(run: Run, log: ProximityLog, rows: ProximityRow[]): void {
    const note = log.note || (log.isRecorded ? 'nothing within the margin' : NOT_RECORDED);
    const state = JSON.stringify([log.body, note, rows.slice(0, MAX_CLOSEST)]);
    if (state === this.listed) return;
    this.listed = state;
    const items = rows.slice(0, MAX_CLOSEST).map((near) => rowOf(run, log.body, near));
    if (rows.length > MAX_CLOSEST) items.push(make('li', {class: 'none'}, `${rows.length - MAX_CLOSEST} more`));
    if (rows.length === 0) items.push(make('li', {class: 'none'}, note));
    el('nearPairs').replaceChildren(...items);
  }

  /** Returns the frame with the least distance around a place on the curve, or the frame at it. */
  private frameAt(x: number): number {
    const {values, first} = this;
    const width = Math.max(1, this.canvas.clientWidth);
    const index = (pixel: number): number =>
      Math.min(values.length - 1, Math.max(0, Math.round((pixel / width) * (values.length - 1))));
    let best = index(x);
    for (let i = index(x - REACH_PX); i <= index(x + REACH_PX); ++i) if (values[i] < values[best]) best = i;
    return first + best;
  }
}

function rowOf(run: Run, body: number, near: ProximityRow): HTMLElement {
  const other = [nameOf(run, near.other), partNameOf(run, near.other, near.otherPart)].filter(Boolean).join(' ');
  const text = `${partNameOf(run, body, near.part)} – ${other}`;
  return bodyRow(run, near.other, '#c9930a', text, distanceText(near));
}
