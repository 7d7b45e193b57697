// ViewPane chooses layers and colours of people, and counts the contacts of a frame.
import {COLORINGS, colorsFor, scaleGradient, type Coloring, type Legend} from './coloring.ts';
import type {ContactLog} from './contacts.ts';
import {LAYERS, type Layer} from './crowd.ts';
import {counted, el, make, setText, thousands} from './dom.ts';
import {matching, type Filter} from './filter.ts';
import {heatOf, valueAt, type HeatCells} from './heat.ts';
import {pairAt, type Frame, type Run} from './protocol.ts';
import type {Source} from './sources.ts';
import type {Stage} from './stage.ts';
import {MARKS} from './theme.ts';

/** Title of each layer, whether it is shown at first, and the list that offers it. */
const LAYER_ROWS: Record<Layer, [string, boolean, 'layers' | 'volumes']> = {
  meshes: ['Bodies', true, 'layers'],
  spheres: ['Avatar spheres', false, 'volumes'],
  hulls: ['or-DOPs of parts', false, 'volumes'],
  boxes: ['AABBs of parts', false, 'volumes'],
  shadows: ['Shadows', true, 'layers'],
  tint: ['Tint candidates', false, 'volumes'],
};

export class ViewPane {
  coloring: Coloring = '';
  private readonly boxes = new Map<Layer, HTMLInputElement>();
  private legend = 'null';
  private heatOf = '';
  private cells: HeatCells | null = null;

  /** `recolor` is called after a choice of colours. */
  constructor(
    private readonly stage: Stage,
    private readonly recolor: () => void,
  ) {
    LAYERS.forEach((layer, index) => {
      const [title, isOn, list] = LAYER_ROWS[layer];
      const box = make('input', {type: 'checkbox', role: 'switch', id: `layer-${layer}`}) as HTMLInputElement;
      box.checked = isOn;
      box.onchange = () => stage.show(layer, box.checked);
      this.boxes.set(layer, box);
      el(list).append(make('label', {class: 'layer'}, make('span', {}, title), make('kbd', {}, String(index + 1)), box));
    });
    MARKS.forEach(({color, name, about}, index) => {
      const row = [make('i', {style: `background:${color}`}), make('span', {}, name), make('output', {}), make('small', {}, about)];
      el('legend').append(make('li', {id: `mark-${index}`}, ...row));
    });
    for (const bar of document.querySelectorAll<HTMLElement>('.scale i')) bar.style.background = scaleGradient();
    el('heat').addEventListener('input', () => this.setHeat(this.heat));
    el('stage').addEventListener('pointermove', ({clientX, clientY}) => this.point(clientX, clientY));
    el('stage').addEventListener('pointerleave', () => (el('heatTip').hidden = true));
    for (const id of ['heatFrom', 'heatTo']) el(id).addEventListener('input', recolor);
    const choice = el<HTMLSelectElement>('coloring');
    choice.append(...COLORINGS.map(([value, name]) => make('option', {value}, name)));
    choice.onchange = () => this.setColoring(choice.value as Coloring);
  }

  get layers(): string[] {
    return LAYERS.filter((layer) => this.boxes.get(layer)!.checked);
  }

  /** Shows these layers, or those that are chosen. */
  showLayers(layers: readonly string[] = this.layers): void {
    for (const [layer, box] of this.boxes) {
      box.checked = layers.includes(layer);
      this.stage.show(layer, box.checked);
    }
  }

  /** Toggles the layer of a key; returns whether it has one. */
  toggle(key: string): boolean {
    const layer = LAYERS[Number(key) - 1];
    if (!layer) return false;
    const isOn = this.layers.includes(layer);
    this.showLayers(isOn ? this.layers.filter((other) => other !== layer) : [...this.layers, layer]);
    return true;
  }

  setColoring(coloring: Coloring): void {
    this.coloring = coloring;
    el<HTMLSelectElement>('coloring').value = coloring;
    this.recolor();
  }

  /** The chosen floor map: from and to in seconds; null: none. */
  get heat(): [number, number] | null {
    if (el<HTMLSelectElement>('heat').value === '') return null;
    const value = (id: string, other: number): number => Math.max(0, el<HTMLInputElement>(id).valueAsNumber || other);
    return [value('heatFrom', 0), value('heatTo', Infinity)];
  }

  /** Whether the floor map shows people per square metre; else contacts. */
  get isDensity(): boolean {
    return el<HTMLSelectElement>('heat').value === 'density';
  }

  setHeat(span: [number, number] | null, isDensity = this.isDensity): void {
    el<HTMLSelectElement>('heat').value = span ? (isDensity ? 'density' : 'contacts') : '';
    el('heatBox').hidden = span === null;
    if (span) {
      el<HTMLInputElement>('heatFrom').value = span[0] > 0 ? String(span[0]) : '';
      el<HTMLInputElement>('heatTo').value = span[1] < Infinity ? String(span[1]) : '';
    }
    this.recolor();
  }

  /** Counts again only if contacts, filter or span have changed. */
  updateHeat(run: Run, filter: Filter, source: Source): void {
    const {heat: span, isDensity} = this;
    const isDark = document.documentElement.dataset.theme === 'dark';
    const shown = isDensity ? source.density.version : [filter, source.contacts.version];
    const state = JSON.stringify([run.run_id, span, span ? [shown, isDensity, isDark] : null]);
    if (state === this.heatOf) return;
    this.heatOf = state;
    this.cells = !span ? null : isDensity ? this.densityOf(run, source) : this.contactsOf(run, filter, source.contacts, span);
    this.stage.setHeat(this.cells, isDark);
    if (!this.cells) el('heatTip').hidden = true;
    el('heatSpan').hidden = isDensity && source.playback === null;
    el('heatScale').style.background = scaleGradient(!isDark);
  }

  private contactsOf(run: Run, filter: Filter, contacts: ContactLog, span: [number, number]): HeatCells {
    const [first, end] = span.map((time_s) => time_s / run.step_s);
    const found = matching(run, {...filter, ofParts: false}, contacts).filter(({begin}) => begin >= first && begin < end);
    const cells = heatOf(run, found);
    setText(el('heatMost'), `${cells.most} in a cell of ${Number(cells.cell_m.toFixed(2))} m`);
    const placed = found.filter(({x_m}) => !Number.isNaN(x_m)).length;
    const missing = found.length - placed;
    setText(el('heatTotal'), counted(placed, 'contact') + (missing > 0 ? `, ${missing} without a known place` : ''));
    return cells;
  }

  private densityOf(run: Run, source: Source): HeatCells | null {
    const {cells, samples, range} = source.density;
    setText(el('heatMost'), cells ? `${cells.most.toFixed(2)} per m² in a cell of ${Number(cells.cell_m.toFixed(2))} m` : '');
    const [first, last] = range.map((frame) => (frame * run.step_s).toFixed(2));
    const since = source.playback ? '' : ', since this page was opened';
    setText(el('heatTotal'), cells ? `mean of ${counted(samples, 'sample')}, ${first}–${last} s${since}` : 'no sample yet');
    return cells;
  }

  /** Shows the place under the mouse and its value. */
  private point(x: number, y: number): void {
    const tip = el('heatTip');
    const at = this.cells ? this.stage.groundAt(x, y) : null;
    const value = at && this.cells ? valueAt(this.cells, at.x, at.y) : null;
    tip.hidden = value === null;
    if (!at || value === null) return;
    const what = this.isDensity ? `${value.toFixed(2)} people per m²` : counted(value, 'contact');
    setText(tip, `${at.x.toFixed(1)}, ${at.y.toFixed(1)} m: ${what}`);
    tip.style.left = `${Math.min(x + 14, innerWidth - tip.offsetWidth - 4)}px`;
    tip.style.top = `${Math.max(4, y - tip.offsetHeight - 8)}px`;
  }

  updateColors(run: Run, frame: Frame, contacts: ContactLog): void {
    const colors = colorsFor(this.coloring, run, frame, contacts);
    const state = JSON.stringify(colors?.legend ?? null);
    if (colors || state !== this.legend) this.stage.setColors(colors?.rgba ?? null);
    if (state !== this.legend) this.showLegend(colors?.legend ?? null);
    this.legend = state;
  }

  private showLegend(legend: Legend | null): void {
    const row = ([name, color]: [string, string]): HTMLElement => make('li', {}, make('i', {style: `background:${color}`}), name);
    el('colorEntries').replaceChildren(...(legend?.entries ?? []).map(row));
    el('colorScale').hidden = !legend?.ends;
    if (!legend?.ends) return;
    setText(el('colorLow'), legend.ends[0]);
    setText(el('colorHigh'), legend.ends[1]);
  }

  /** Hides levels that do not occur in this run. */
  updateCounts(run: Run, frame: Frame): void {
    if (el('viewPane').hidden) return;
    const counts = [frame.crowded, 0, 0, 0, 0];
    for (let i = 0; i < frame.pairs; ++i) ++counts[pairAt(frame, i).level + 1];
    const decided = run.exact ? 4 : 3;
    counts.forEach((count, index) => {
      const row = el(`mark-${index}`);
      row.hidden = index > 0 && index !== decided && count === 0;
      setText(row.querySelector('output')!, thousands(count));
    });
  }
}
