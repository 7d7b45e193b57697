// A link stores what a page shows: frame, selection, camera, layers, colours, filter and theme.
// Invariant: readLink(writeLink(view)) equals the view; wrong text yields only what can be read.
import {COLORINGS, type Coloring} from './coloring.ts';
import type {Rect} from './framing.ts';
import {NO_FILTER, type Filter, type Order, type Other} from './filter.ts';
import type {ThemeName} from './theme.ts';

export interface PageView {
  /** Null in live runs. */
  frame: number | null;
  selected: number[];
  /** Parts of the selected contact; empty: all of the selected bodies. */
  parts: number[];
  isFollowing: boolean;
  tab: string;
  /** Camera position and target in metres. */
  camera: number[];
  layers: string[];
  coloring: Coloring;
  /** Span of the floor map in seconds; null: none. */
  heat: [number, number] | null;
  /** Whether the floor map shows people per square metre; else contacts. */
  isDensity: boolean;
  filter: Filter;
  /** The theme that the reader chose; null: that of the system. */
  theme: ThemeName | null;
}

/** Returns the text after "#". Millimetres suffice for the camera. */
export function writeLink(view: PageView): string {
  const {filter} = view;
  const fields: [string, string][] = [
    ['frame', view.frame === null ? '' : String(view.frame)],
    ['selected', view.selected.join(',')],
    ['parts', view.parts.join(',')],
    ['follow', view.isFollowing ? '1' : ''],
    ['tab', view.tab],
    ['camera', view.camera.map((value) => value.toFixed(4)).join(',')],
    ['layers', view.layers.join(',')],
    ['color', view.coloring],
    ['heat', view.heat ? view.heat.map((time_s) => (time_s < Infinity ? time_s : '')).join(',') : ''],
    ['map', view.heat && view.isDensity ? 'density' : ''],
    ['rows', filter.ofParts ? 'parts' : ''],
    ['with', filter.with],
    ['group', filter.group],
    ['body', filter.body < 0 ? '' : String(filter.body)],
    ['part', filter.part],
    ['min', filter.min_s > 0 ? String(filter.min_s) : ''],
    ['order', filter.order === 'time' && !filter.isDescending ? '' : `${filter.order}${filter.isDescending ? '-' : ''}`],
    ['theme', view.theme ?? ''],
  ];
  return textOf(new URLSearchParams(fields.filter(([name, value]) => value !== '' || name === 'layers')));
}

function textOf(fields: URLSearchParams): string {
  return fields.toString().replaceAll('%2C', ',');
}

/** Returns a link with another theme. */
export function withTheme(text: string, theme: ThemeName): string {
  const fields = new URLSearchParams(text.replace(/^#/, ''));
  fields.set('theme', theme);
  return textOf(fields);
}

/** Returns a command that draws the free part of a window of this height, seen with this angle of view. */
export function renderCommand(scene: string, view: PageView, free: Rect, height: number, fov_deg: number): string {
  const size = [free.right - free.left, free.bottom - free.top].map(Math.round);
  const half = Math.tan((fov_deg * Math.PI) / 360) * (size[1] / height);
  const fov = ((360 / Math.PI) * Math.atan(half)).toFixed(3);
  const [eye, target] = [view.camera.slice(0, 3), view.camera.slice(3)].map((point) => point.map((value) => value.toFixed(4)).join(','));
  const name = `${scene}-${view.frame ?? 0}`;
  return `throng render out/${scene}.lcmlog --frame ${view.frame ?? 0} --eye ${eye} --target ${target} --fov ${fov} --width ${size[0]} --height ${size[1]} --out ${name}.png`;
}

/** Returns whether numbers are a position and another point to look at, both in reach. */
function isCamera(values: number[]): boolean {
  const [x, y, z, ...target] = values;
  const away = Math.hypot(x - target[0], y - target[1], z - target[2]);
  return values.length === 6 && values.every((value) => Math.abs(value) < 1e5) && away > 0.1;
}

export function readLink(text: string): Partial<PageView> {
  const fields = new URLSearchParams(text.replace(/^#/, ''));
  const view: Partial<PageView> = {};
  const numbers = (name: string): number[] => {
    const values = (fields.get(name) ?? '').split(',').filter(Boolean).map(Number);
    return values.every(Number.isFinite) ? values : [];
  };
  const natural = (name: string): number => {
    const value = Number(fields.get(name) || -1);
    return Number.isInteger(value) && value >= 0 ? value : -1;
  };
  if (natural('frame') >= 0) view.frame = natural('frame');
  if (fields.has('selected')) view.selected = numbers('selected').filter((id) => Number.isInteger(id) && id >= 0).slice(0, 2);
  if (numbers('parts').length === 2) view.parts = numbers('parts');
  if (fields.get('follow') === '1') view.isFollowing = true;
  if (fields.get('tab')) view.tab = fields.get('tab')!;
  if (isCamera(numbers('camera'))) view.camera = numbers('camera');
  if (fields.has('layers')) view.layers = fields.get('layers')!.split(',').filter(Boolean);
  const color = COLORINGS.find(([coloring]) => coloring === fields.get('color'));
  if (color) view.coloring = color[0];
  const span = /^([\d.]*),([\d.]*)$/.exec(fields.get('heat') ?? '');
  if ([...fields.keys()].length > 0) view.heat = span ? [Number(span[1]) || 0, Number(span[2]) || Infinity] : null;
  const theme = (['light', 'dark'] as const).find((name) => name === fields.get('theme'));
  if (theme) view.theme = theme;
  if (view.heat) view.isDensity = fields.get('map') === 'density';
  const order = /^(time|length|who)(-?)$/.exec(fields.get('order') ?? '');
  const other = ['people', 'robots', 'obstacles'].find((name) => name === fields.get('with'));
  if ([...fields.keys()].length > 0)
    view.filter = {
      ...NO_FILTER,
      ofParts: fields.get('rows') === 'parts',
      with: (other ?? '') as Other,
      group: fields.get('group') ?? '',
      body: natural('body'),
      part: fields.get('part') ?? '',
      min_s: Math.max(0, Number(fields.get('min')) || 0),
      order: (order?.[1] ?? 'time') as Order,
      isDescending: order?.[2] === '-',
    };
  return view;
}
