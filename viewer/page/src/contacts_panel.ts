// ContactsPanel lists contacts: filters, order, and rows that open a contact.
// Invariant: only the rows in sight exist as elements, for any number of contacts.
import type {Contact, ContactLog} from './contacts.ts';
import {counted, el, make, setText, thousands} from './dom.ts';
import {matches, matching, NO_FILTER, partNames, select, type Bodies, type Filter, type Order, type Other} from './filter.ts';
import {whenOf} from './playback.ts';
import {nameOf, partNameOf, type Run} from './protocol.ts';

/** Same height as in the style sheet. */
const ROW_PX = 46;
const SPARE_ROWS = 4;
const WITH: [Other, string][] = [
  ['', 'anything'],
  ['people', 'people only'],
  ['robots', 'robots'],
  ['obstacles', 'obstacles'],
];

export class ContactsPanel {
  filter: Filter = {...NO_FILTER};
  /** The contact that was opened last. */
  chosen: Contact | null = null;
  private run: Run | null = null;
  private log: ContactLog | null = null;
  private rows: Contact[] = [];
  private readonly pool: HTMLElement[] = [];
  private listed = '';
  /** The filter for pairs of a frame, which are pairs of parts. */
  private pairFilter: Filter = {...NO_FILTER, ofParts: true};
  private long = {frame: -1, version: -1, filter: this.filter, keys: new Set<string>()};
  private active = 0;

  /** `open` shows a contact; `changed` is called after each change of the filter. */
  constructor(
    private readonly open: (contact: Contact) => void,
    private readonly changed: () => void,
  ) {
    const list = el('rows');
    list.addEventListener('scroll', () => this.fill());
    list.addEventListener('click', (event) => {
      const row = (event.target as HTMLElement).closest<HTMLElement>('.row');
      if (row) this.openRow(Number(row.dataset.index));
    });
    list.addEventListener('keydown', (event) => this.key(event));
    new ResizeObserver(() => this.fill()).observe(list);
    el('withFilter').append(...WITH.map(([value, name]) => make('option', {value}, name)));
    this.onChange('withFilter', (value) => ({with: value as Other}));
    this.onChange('groupFilter', (value) => ({group: value}));
    this.onChange('rowsFilter', (value) => ({ofParts: value === 'parts'}));
    this.onChange('partFilter', (value) => ({part: value, ...(value === '' ? {} : {ofParts: true})}));
    this.onChange('minFilter', (value) => ({min_s: Math.max(0, Number(value) || 0)}));
    for (const order of ['time', 'length', 'who'] as Order[])
      el(`order-${order}`).onclick = () => {
        // Long contacts first; a second click turns the order around.
        const isDescending = this.filter.order === order ? !this.filter.isDescending : order === 'length';
        this.set({order, isDescending});
      };
    el('clearFilter').onclick = () => this.set({...NO_FILTER, order: this.filter.order, isDescending: this.filter.isDescending});
    el('bodyFilter').onclick = () => this.set({body: -1});
  }

  setRun(run: Run, log: ContactLog): void {
    this.run = run;
    this.log = log;
    this.chosen = null;
    const options = (names: string[], any: string): HTMLElement[] => [
      make('option', {value: ''}, any),
      ...names.map((name) => make('option', {value: name}, name)),
    ];
    el('groupFilter').replaceChildren(...options([...new Set(run.groups)], 'any group'));
    el('partFilter').replaceChildren(...options(partNames(run), 'any part'));
    this.set({});
  }

  set(change: Partial<Filter>): void {
    this.filter = {...this.filter, ...change};
    this.pairFilter = {...this.filter, ofParts: true};
    this.listed = '';
    this.showFilter();
    this.update();
    this.changed();
  }

  /** Lists the contacts known so far. */
  update(): void {
    const {run, log} = this;
    if (!run || !log || el('contactsPane').hidden) return;
    const state = JSON.stringify([log.version, this.filter]);
    if (state === this.listed) return;
    this.listed = state;
    this.rows = select(run, this.filter, log);
    const all = this.filter.ofParts ? log.ofParts.length : log.ofBodies.length;
    const count = counted(this.rows.length, 'contact');
    setText(el('rowCount'), this.rows.length === all ? count : `${thousands(this.rows.length)} of ${counted(all, 'contact')}`);
    el('rowsSpace').classList.toggle('none', this.rows.length === 0);
    el('rowsSpace').style.height = `${ROW_PX * this.rows.length}px`;
    el('rows').setAttribute('aria-rowcount', String(this.rows.length));
    this.active = Math.max(0, Math.min(this.rows.length - 1, this.active));
    if (this.chosen && !this.rows.includes(this.chosen)) this.chosen = null;
    this.fill();
  }

  /** Opens the next (1) or previous (-1) contact of the list. */
  step(direction: number): void {
    this.update();
    if (this.rows.length === 0) return;
    const at = this.chosen ? this.rows.indexOf(this.chosen) : -1;
    const next = at < 0 ? (direction > 0 ? 0 : this.rows.length - 1) : at + direction;
    this.openRow(Math.max(0, Math.min(this.rows.length - 1, next)));
  }

  /** Returns whether a pair of a frame belongs to a listed contact; its length is known from the list only. */
  shows(pair: Bodies, frame: number): boolean {
    const {run, filter} = this;
    if (!run || !matches(run, this.pairFilter, pair)) return false;
    return filter.min_s === 0 || this.longAt(frame).has(keyOf(pair, filter.ofParts));
  }

  /** Returns the keys of listed contacts that exist in a frame. */
  private longAt(frame: number): Set<string> {
    const {run, log, filter, long} = this;
    if (!run || !log || (long.frame === frame && long.version === log.version && long.filter === filter)) return long.keys;
    const keys = new Set<string>();
    for (const contact of matching(run, filter, log)) if (lasts(contact, frame)) keys.add(keyOf(contact, filter.ofParts));
    this.long = {frame, version: log.version, filter, keys};
    return keys;
  }

  /** Marks the row of a pair that touches in a frame, if it is listed. */
  mark(pair: Bodies, frame: number): void {
    this.update();
    const key = keyOf(pair, this.filter.ofParts);
    const index = this.rows.findIndex((contact) => lasts(contact, frame) && keyOf(contact, this.filter.ofParts) === key);
    this.chosen = this.rows[index] ?? null;
    if (index >= 0) this.reveal((this.active = index));
    this.fill();
  }

  clear(): void {
    this.chosen = null;
    this.fill();
  }

  /** Rows for tests and scripts. */
  get listedRows(): Contact[] {
    return this.rows;
  }

  private openRow(index: number): void {
    this.chosen = this.rows[index] ?? null;
    this.active = index;
    this.reveal(index);
    this.fill();
    if (this.chosen) this.open(this.chosen);
  }

  private reveal(index: number): void {
    const list = el('rows');
    const top = ROW_PX * index;
    if (top < list.scrollTop) list.scrollTop = top;
    else if (top + ROW_PX > list.scrollTop + list.clientHeight) list.scrollTop = top + ROW_PX - list.clientHeight;
  }

  private key(event: KeyboardEvent): void {
    const page = Math.max(1, Math.floor(el('rows').clientHeight / ROW_PX) - 1);
    const moves: Record<string, number> = {
      ArrowDown: 1,
      ArrowUp: -1,
      PageDown: page,
      PageUp: -page,
      Home: -this.rows.length,
      End: this.rows.length,
    };
    const move = moves[event.key];
    if (move === undefined && event.key !== 'Enter') return;
    event.preventDefault();
    event.stopPropagation();
    if (move === undefined) return this.openRow(this.active);
    this.active = Math.max(0, Math.min(this.rows.length - 1, this.active + move));
    this.reveal(this.active);
    this.fill();
  }

  private fill(): void {
    const list = el('rows');
    const count = Math.ceil(list.clientHeight / ROW_PX) + SPARE_ROWS;
    while (this.pool.length < count) {
      const row = make('div', {class: 'row', role: 'row'}, make('div', {role: 'gridcell'}, make('span'), make('time')));
      this.pool.push(row);
      el('rowsSpace').append(row);
    }
    const first = Math.max(0, Math.min(Math.floor(list.scrollTop / ROW_PX) - SPARE_ROWS / 2, this.rows.length - this.pool.length));
    for (let i = 0; i < this.pool.length; ++i) this.show(first + i);
    list.setAttribute('aria-activedescendant', `row-${this.active % this.pool.length}`);
  }

  /** An element shows every pool.length-th contact, so that scrolling changes few of them. */
  private show(index: number): void {
    const {run, log} = this;
    const place = index % this.pool.length;
    const row = this.pool[place];
    const contact = this.rows[index];
    row.hidden = !contact;
    if (!contact || !run || !log) return;
    row.id = `row-${place}`;
    row.dataset.index = String(index);
    row.style.transform = `translateY(${ROW_PX * index}px)`;
    row.classList.toggle('chosen', contact === this.chosen);
    row.classList.toggle('active', index === this.active);
    row.setAttribute('aria-rowindex', String(index + 1));
    row.setAttribute('aria-selected', String(contact === this.chosen));
    const more = contact.parts > 1 ? `, ${contact.parts} pairs of parts` : '';
    setText(row.querySelector('span')!, titleOf(run, contact));
    setText(row.querySelector('time')!, whenOf(contact, log.lastFrame, run.step_s) + more);
    row.title = `${titleOf(run, contact)}, ${whenOf(contact, log.lastFrame, run.step_s)}`;
  }

  private onChange(id: string, change: (value: string) => Partial<Filter>): void {
    el<HTMLInputElement>(id).addEventListener('input', (event) => this.set(change((event.target as HTMLInputElement).value)));
  }

  private showFilter(): void {
    const {filter, run} = this;
    const values: Record<string, string> = {
      withFilter: filter.with,
      groupFilter: filter.group,
      rowsFilter: filter.ofParts ? 'parts' : 'bodies',
      partFilter: filter.ofParts ? filter.part : '',
      minFilter: filter.min_s > 0 ? String(filter.min_s) : '',
    };
    // A field keeps the text that is being typed.
    for (const [id, value] of Object.entries(values))
      if (document.activeElement !== el(id) || id !== 'minFilter') el<HTMLInputElement>(id).value = value;
    for (const order of ['time', 'length', 'who'] as Order[]) {
      const isUsed = order === filter.order;
      el(`order-${order}`).setAttribute('aria-pressed', String(isUsed));
      setText(el(`arrow-${order}`), isUsed ? (filter.isDescending ? ' ↓' : ' ↑') : '');
    }
    const isFiltered = filter.with !== '' || filter.group !== '' || filter.body >= 0 || filter.part !== '' || filter.min_s > 0;
    el('clearFilter').hidden = !isFiltered;
    el('bodyFilter').hidden = filter.body < 0 || !run;
    if (filter.body >= 0 && run) setText(el('bodyFilter'), `with ${nameOf(run, filter.body)}`);
  }
}

const keyOf = ({a, b, partA, partB}: Bodies, ofParts: boolean): string => (ofParts ? `${a} ${b} ${partA} ${partB}` : `${a} ${b}`);

const lasts = ({begin, end}: Contact, frame: number): boolean => begin <= frame && (end < 0 || frame < end);

/** Returns "people 312 left hand – robot 4 arm", without parts if several touch. */
function titleOf(run: Run, {a, b, partA, partB, parts}: Contact): string {
  const side = (body: number, part: number): string =>
    [nameOf(run, body), parts === 1 ? partNameOf(run, body, part) : ''].filter(Boolean).join(' ');
  return `${side(a, partA)} – ${side(b, partB)}`;
}
