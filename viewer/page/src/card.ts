// Card shows the selected person: its present contacts from the frame, past ones from the source.
import {el, make, setText} from './dom.ts';
import {heightOf} from './framing.ts';
import {since, whenOf} from './playback.ts';
import {nameOf, pairsOf, partNameOf, personOf, type Frame, type Pair, type Run} from './protocol.ts';
import {MARKS} from './theme.ts';

/** A past contact: began, end or -1, a, b, part_a, part_b. */
export type PastContact = [number, number, number, number, number, number];

/** Maximum number of past contacts in the list. */
const MAX_ROWS = 14;

export class Card {
  id = -1;
  private past: PastContact[] = [];
  private drawn = '';

  constructor(choose: (id: number) => void) {
    for (const list of ['cardPairs', 'cardHistory']) bindBodies(list, choose);
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

  setHistory(past: PastContact[]): void {
    this.past = past;
  }

  update(run: Run, frame: Frame): void {
    if (this.id < 0 || this.id >= frame.avatars) return;
    const person = personOf(frame, this.id);
    const height_m = heightOf(run, this.id);
    setText(
      el('cardState'),
      person.present
        ? `${person.speed_mps.toFixed(2)} m/s · ${height_m.toFixed(2)} m tall · at ${person.position_m[0].toFixed(1)}, ${person.position_m[1].toFixed(1)} m`
        : 'not in the scene at this time',
    );
    const now = pairsOf(frame, this.id);
    const times = now.map((pair) => since(pair.began, frame.number, run.step_s));
    const before = this.past.filter(([, end]) => end >= 0 && end <= frame.number).slice(0, MAX_ROWS);
    // The lists are rebuilt only when their pairs change; otherwise only the times are updated.
    const state = JSON.stringify([now, before]);
    if (state !== this.drawn) {
      this.drawn = state;
      fill('cardPairs', now.map((pair) => this.row(run, pair)));
      fill(
        'cardHistory',
        before.map(([began, end, a, b, partA, partB]) => {
          const when = {begin: began < 0 ? ~began : began, end, isOlder: began < 0, isLost: false};
          return this.row(run, {a, b, partA, partB, level: -1, began}, whenOf(when, frame.number, run.step_s));
        }),
      );
    }
    el('cardPairs')
      .querySelectorAll('time')
      .forEach((time, i) => setText(time, times[i]));
  }

  private row(run: Run, pair: Pair, time = ''): HTMLElement {
    const isA = pair.a === this.id;
    const [ownPart, other, otherPart] = isA ? [pair.partA, pair.b, pair.partB] : [pair.partB, pair.a, pair.partA];
    const color = pair.level < 0 ? 'var(--edge)' : MARKS[pair.level + 1].color;
    const otherPartName = partNameOf(run, other, otherPart);
    const text = `${partNameOf(run, this.id, ownPart)} – ${nameOf(run, other)}${otherPartName ? ` ${otherPartName}` : ''}`;
    return bodyRow(run, other, color, text, time);
  }
}

/** Returns a row about another body; that of a person or robot is clicked to select it. */
export function bodyRow(run: Run, other: number, color: string, text: string, value: string): HTMLElement {
  const isAvatar = other < run.avatars;
  const attributes: Record<string, string> = isAvatar ? {'data-body': String(other)} : {};
  const name = make(isAvatar ? 'button' : 'span', {}, text);
  return make('li', attributes, make('i', {style: `background:${color}`}), name, make('time', {'aria-live': 'off'}, value));
}

/** A click on a row of a list selects its body. */
export function bindBodies(list: string, choose: (id: number) => void): void {
  el(list).addEventListener('click', (event) => {
    const row = (event.target as HTMLElement).closest<HTMLElement>('li[data-body]');
    if (row) choose(Number(row.dataset.body));
  });
}

function fill(list: string, rows: HTMLElement[]): void {
  el(list).replaceChildren(...(rows.length ? rows : [make('li', {class: 'none'}, 'nothing')]));
}
