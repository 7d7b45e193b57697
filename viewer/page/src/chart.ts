// Chart draws a small line over time: touching pairs, or milliseconds per frame.
// Invariant: a peak never falls between two pixels.

const MARK_PX = 4;
const MARK_COLOR = '#d55e00';

export interface ChartStyle {
  line: string;
  fill: string;
  text: string;
  cursor: string;
}

/** Returns the largest value of each of `columns` slices. */
export function peaks(values: ArrayLike<number>, columns: number): number[] {
  const out: number[] = [];
  for (let c = 0; c < columns; ++c) {
    const from = Math.floor((c * values.length) / columns);
    const to = Math.max(from + 1, Math.floor(((c + 1) * values.length) / columns));
    let max = 0;
    for (let i = from; i < to && i < values.length; ++i) max = Math.max(max, values[i]);
    out.push(max);
  }
  return out;
}

/** Returns the least value of each of `columns` slices. */
export function valleys(values: ArrayLike<number>, columns: number): number[] {
  return Array.from({length: columns}, (_, c) => {
    const from = Math.floor((c * values.length) / columns);
    const to = Math.max(from + 1, Math.floor(((c + 1) * values.length) / columns));
    let min = Infinity;
    for (let i = from; i < to && i < values.length; ++i) min = Math.min(min, values[i]);
    return min;
  });
}

/** Rounds up to 1, 2 or 5 times a power of ten. */
export function roundUp(value: number): number {
  if (value <= 0) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  for (const factor of [1, 2, 5, 10]) if (factor * power >= value) return factor * power;
  return 10 * power;
}

export class Chart {
  private readonly context: CanvasRenderingContext2D;
  /** In CSS pixels; zero while it is not shown. */
  private size: [number, number] = [0, 0];
  private drawn: readonly unknown[] = [];

  /** `resized` is called when the chart has to be drawn again. */
  constructor(
    private readonly canvas: HTMLCanvasElement,
    resized: () => void,
  ) {
    // Drawn by the processor: a chart must not wait for a busy graphics card.
    this.context = canvas.getContext('2d', {willReadFrequently: true})!;
    // Asking the canvas for its size would compute the layout of the page in each update.
    new ResizeObserver(([entry]) => {
      this.size = [Math.round(entry!.contentRect.width), Math.round(entry!.contentRect.height)];
      resized();
    }).observe(canvas);
  }

  /** Returns whether the chart has to be drawn: it is shown, and its size or these values have changed. */
  isOld(...values: readonly unknown[]): boolean {
    const [width] = this.size;
    if (width === 0) return false;
    const drawn = [...this.size, window.devicePixelRatio, ...values];
    const isOld = drawn.length !== this.drawn.length || drawn.some((value, i) => value !== this.drawn[i]);
    this.drawn = drawn;
    return isOld;
  }

  /** Returns the size in CSS pixels of the emptied canvas. */
  private cleared(): [number, number] {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = this.size;
    if (this.canvas.width !== Math.round(width * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.context.clearRect(0, 0, width, height);
    return [width, height];
  }

  private finish(top: string, style: ChartStyle, cursor: number): void {
    const c = this.context;
    const [width, height] = this.size;
    c.fillStyle = style.text;
    c.font = '10px system-ui, sans-serif';
    c.fillText(top, 3, 10);
    if (cursor < 0) return;
    c.fillStyle = style.cursor;
    c.fillRect(Math.min(width - 1.5, cursor * width), 0, 1.5, height);
  }

  /** Draws the least values, with gaps where none is finite. Call it, as draw(), where isOld() returns true. */
  drawLeast(values: ArrayLike<number>, label: (value: number) => string, style: ChartStyle, cursor = -1): void {
    const [width, height] = this.cleared();
    const c = this.context;
    const columns = Math.max(2, Math.min(Math.floor(width), values.length));
    const lows = valleys(values, columns);
    const top = roundUp(lows.reduce((most, low) => (low < Infinity ? Math.max(most, low) : most), 0));
    c.beginPath();
    lows.forEach((low, i) => {
      if (low === Infinity) return;
      const x = (i / (columns - 1)) * (width - 2) + 1;
      const y = height - 1.5 - (low / top) * (height - 4);
      if (i > 0 && lows[i - 1] < Infinity) c.lineTo(x, y);
      else c.moveTo(x - 0.75, y);
      c.lineTo(x + 0.75, y); // a single value is visible
    });
    c.strokeStyle = style.line;
    c.lineWidth = 1.5;
    c.stroke();
    this.finish(label(top), style, cursor);
  }

  /** Draws bars at the top over spans of frames; `last`: the frame at the right end. */
  mark(spans: readonly [number, number][], last: number): void {
    const [width] = this.size;
    this.context.fillStyle = MARK_COLOR;
    for (const [begin, end] of spans) {
      const left = (begin / Math.max(1, last)) * width;
      this.context.fillRect(Math.min(left, width - 2), 0, Math.max(2, ((end - begin) / Math.max(1, last)) * width), MARK_PX);
    }
  }

  /** `label`: formats a value; `cursor`: 0 to 1 along the time axis, or -1. */
  draw(values: ArrayLike<number>, label: (value: number) => string, style: ChartStyle, cursor = -1): void {
    const [width, height] = this.cleared();
    const c = this.context;
    const columns = Math.max(2, Math.min(Math.floor(width), values.length));
    const heights = peaks(values, columns);
    const top = roundUp(Math.max(0, ...heights));
    const y = (value: number): number => height - 1 - (value / top) * (height - 4);
    const x = (i: number): number => (i / (columns - 1)) * width;
    c.beginPath();
    c.moveTo(0, height);
    heights.forEach((value, i) => c.lineTo(x(i), y(value)));
    c.lineTo(width, height);
    c.fillStyle = style.fill;
    c.fill();
    c.beginPath();
    heights.forEach((value, i) => (i === 0 ? c.moveTo(x(i), y(value)) : c.lineTo(x(i), y(value))));
    c.strokeStyle = style.line;
    c.lineWidth = 1.5;
    c.stroke();
    this.finish(label(top), style, cursor);
  }
}
