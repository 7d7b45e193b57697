// Finder finds people, robots, groups and obstacles by number or name.
import {el, make} from './dom.ts';
import {isPerson, nameOf, type Run} from './protocol.ts';

export type Finding = {body: number; name: string} | {group: string; name: string};

const MAX_FOUND = 8;

/** Returns what matches, best first: exact numbers, then beginnings of names, then parts of names. */
export function find(run: Run, query: string, max = MAX_FOUND): Finding[] {
  const text = query.trim().toLowerCase();
  if (text === '') return [];
  const ranked: [number, Finding][] = [];
  const rank = (name: string): number => {
    const at = name.toLowerCase().indexOf(text);
    return at < 0 ? Infinity : at === 0 ? 1 : 2;
  };
  const bodies = run.avatars + run.obstacles.length;
  const robots = run.models.filter((model) => !model.is_person).map((model) => model.name.toLowerCase());
  const asksRobots = 'robots'.startsWith(text) || robots.some((name) => name.startsWith(text));
  for (const group of new Set(run.groups))
    if (Math.min(rank(group), rank(`group ${group}`)) < Infinity) ranked.push([1, {group, name: `group ${group}`}]);
  for (let body = 0; body < bodies; ++body) {
    const name = nameOf(run, body);
    const isNumber = body < run.avatars && (String(body) === text || name.toLowerCase() === text);
    const isRobot = asksRobots && body < run.avatars && !isPerson(run, body);
    const value = isNumber ? 0 : isRobot ? 1 : body < run.avatars && /^\d+$/.test(text) ? Infinity : rank(name);
    if (value < Infinity) ranked.push([value, {body, name}]);
    if (ranked.length > 50 * max) break; // a word that fits everything
  }
  return ranked
    .sort(([p], [q]) => p - q)
    .slice(0, max)
    .map(([, finding]) => finding);
}

export class Finder {
  private run: Run | null = null;
  private found: Finding[] = [];
  private active = 0;

  constructor(private readonly choose: (finding: Finding) => void) {
    const input = el<HTMLInputElement>('find');
    input.addEventListener('input', () => this.update());
    input.addEventListener('keydown', (event) => this.key(event));
    input.addEventListener('blur', () => setTimeout(() => this.close(), 150));
    el('found').addEventListener('pointerdown', (event) => {
      const row = (event.target as HTMLElement).closest<HTMLElement>('li[data-index]');
      event.preventDefault();
      if (row) this.take(Number(row.dataset.index));
    });
  }

  setRun(run: Run): void {
    this.run = run;
    this.close();
  }

  focus(): void {
    el<HTMLInputElement>('find').focus();
    el<HTMLInputElement>('find').select();
  }

  private key(event: KeyboardEvent): void {
    event.stopPropagation();
    if (event.key === 'Escape') {
      el<HTMLInputElement>('find').value = '';
      el('find').blur();
      return this.close();
    }
    if (event.key === 'Enter') return this.take(this.active);
    const move = event.key === 'ArrowDown' ? 1 : event.key === 'ArrowUp' ? -1 : 0;
    if (move === 0 || this.found.length === 0) return;
    event.preventDefault();
    this.active = (this.active + move + this.found.length) % this.found.length;
    this.show();
  }

  private update(): void {
    this.found = this.run ? find(this.run, el<HTMLInputElement>('find').value) : [];
    this.active = 0;
    this.show();
  }

  private show(): void {
    const isEmpty = el<HTMLInputElement>('find').value.trim() === '';
    el('found').hidden = isEmpty;
    el('find').setAttribute('aria-expanded', String(!isEmpty));
    const rows = this.found.map(({name}, index) =>
      make('li', {role: 'option', id: `found-${index}`, 'data-index': String(index), 'aria-selected': String(index === this.active)}, name),
    );
    el('found').replaceChildren(...(rows.length ? rows : [make('li', {role: 'option', class: 'none', 'aria-disabled': 'true', 'aria-selected': 'false'}, 'nothing found')]));
    if (rows.length) el('find').setAttribute('aria-activedescendant', `found-${this.active}`);
    else el('find').removeAttribute('aria-activedescendant');
  }

  private take(index: number): void {
    const finding = this.found[index];
    if (!finding) return;
    el<HTMLInputElement>('find').value = '';
    el('find').blur();
    this.close();
    this.choose(finding);
  }

  private close(): void {
    this.found = [];
    el('found').hidden = true;
    el('find').setAttribute('aria-expanded', 'false');
    el('find').removeAttribute('aria-activedescendant');
  }
}
