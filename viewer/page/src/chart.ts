// Chart draws a small line over time: touching pairs, or milliseconds per frame.
// Invariant: a peak never falls between two pixels.

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

/** Rounds up to 1, 2 or 5 times a power of ten. */
export function roundUp(value: number): number {
  if (value <= 0) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  for (const factor of [1, 2, 5, 10]) if (factor * power >= value) return factor * power;
  return 10 * power;
}

export class Chart {
  private readonly context: CanvasRenderingContext2D;

  constructor(private readonly canvas: HTMLCanvasElement) {
    // Drawn by the processor: a chart must not wait for a busy graphics card.
    this.context = canvas.getContext('2d', {willReadFrequently: true})!;
  }

  /** `label`: formats a value; `cursor`: 0 to 1 along the time axis, or -1. */
  draw(values: ArrayLike<number>, label: (value: number) => string, style: ChartStyle, cursor = -1): void {
    const ratio = window.devicePixelRatio || 1;
    const width = this.canvas.clientWidth;
    const height = this.canvas.clientHeight;
    if (width === 0) return;
    if (this.canvas.width !== Math.round(width * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    const c = this.context;
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.clearRect(0, 0, width, height);
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
    c.fillStyle = style.text;
    c.font = '10px system-ui, sans-serif';
    c.fillText(label(top), 3, 10);
    if (cursor < 0) return;
    c.fillStyle = style.cursor;
    c.fillRect(Math.min(width - 1.5, cursor * width), 0, 1.5, height);
  }
}
