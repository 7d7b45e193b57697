// What is known of the person who was clicked.
// One rule: names what the frame says now, and asks the source for what was before.
import {el, make, setText} from './dom.ts';
import {nameOf, pairsOf, partNameOf, personOf, type Frame, type Pair, type Run} from './protocol.ts';
import {MARKS} from './theme.ts';

/** begin, end or -1, a, b, part_a, part_b: a pair that was. */
export type Past = [number, number, number, number, number, number];

export class Card {
  id = -1;
  private past: Past[] = [];
  private drawn = '';

  constructor(private readonly choose: (id: number) => void) {
    for (const list of ['cardPairs', 'cardHistory'])
      el(list).addEventListener('click', (event) => {
        const row = (event.target as HTMLElement).closest<HTMLElement>('li[data-body]');
        if (row) this.choose(Number(row.dataset.body));
      });
  }

  open(run: Run, id: number): void {
    this.id = id;
    this.past = [];
    this.drawn = '';
    el('card').hidden = false;
    setText(el('cardName'), nameOf(run, id));
  }

  close(): void {
    this.id = -1;
    el('card').hidden = true;
  }

  setHistory(past: Past[]): void {
    this.past = past;
  }

  update(run: Run, frame: Frame): void {
    if (this.id < 0 || this.id >= frame.avatars) return;
    const person = personOf(frame, this.id);
    const height_m = run.models[run.modelOfAvatar[this.id]].height_m * run.scaleOfAvatar[this.id];
    setText(
      el('cardState'),
      person.present
        ? `${person.speed_mps.toFixed(2)} m/s · ${height_m.toFixed(2)} m tall · at ${person.position_m[0].toFixed(1)}, ${person.position_m[1].toFixed(1)} m`
        : 'not in the scene at this time',
    );
    const now = pairsOf(frame, this.id);
    const before = this.past.filter(([, end]) => end >= 0 && end <= frame.number);
    // Lists are rebuilt only when they say something else.
    const state = JSON.stringify([now, before]);
    if (state === this.drawn) return;
    this.drawn = state;
    const rows = now.map((pair) => this.row(run, pair, sinceOf(this.past, pair, frame.number, run.step_s)));
    el('cardPairs').replaceChildren(...(rows.length ? rows : [make('li', {class: 'none'}, 'nothing')]));
    const old = before.slice(0, 14).map(([begin, end, a, b, partA, partB]) =>
      this.row(run, {a, b, partA, partB, level: -1}, `${((end - begin) * run.step_s).toFixed(2)} s`),
    );
    el('cardHistory').replaceChildren(...(old.length ? old : [make('li', {class: 'none'}, 'nothing')]));
  }

  private row(run: Run, pair: Pair, time: string): HTMLElement {
    const isA = pair.a === this.id;
    const [mine, other, theirs] = isA ? [pair.partA, pair.b, pair.partB] : [pair.partB, pair.a, pair.partA];
    const color = pair.level < 0 ? 'var(--edge)' : MARKS[pair.level + 1].color;
    const theirPart = partNameOf(run, other, theirs);
    const text = `${partNameOf(run, this.id, mine)} – ${nameOf(run, other)}${theirPart ? ` ${theirPart}` : ''}`;
    const attributes: Record<string, string> = other < run.avatars ? {'data-body': String(other)} : {};
    return make('li', attributes, make('i', {style: `background:${color}`}), make('span', {}, text), make('time', {}, time));
  }
}

function sinceOf(past: Past[], pair: Pair, frame: number, step_s: number): string {
  const known = past.find(
    ([begin, end, a, b, partA, partB]) =>
      a === pair.a && b === pair.b && partA === pair.partA && partB === pair.partB && begin <= frame && (end < 0 || end > frame),
  );
  return known ? `${((frame - known[0]) * step_s).toFixed(1)} s` : '';
}
