// Filter chooses contacts and people: by group, body, part, length and by what the other body is.
import type {Contact, ContactLog} from './contacts.ts';
import {displayName, isPerson, partNameOf, type Run} from './protocol.ts';

export type Other = '' | 'people' | 'robots' | 'obstacles';
export type Order = 'time' | 'length' | 'who';

export interface Filter {
  /** Whether rows are contacts of parts; else of bodies. */
  ofParts: boolean;
  with: Other;
  /** Name of a group of one of the bodies; '': any. */
  group: string;
  /** One of the bodies; -1: any. */
  body: number;
  /** Name of one of the parts; '': any. Applies to contacts of parts. */
  part: string;
  min_s: number;
  order: Order;
  isDescending: boolean;
}

export const NO_FILTER: Filter = {
  ofParts: false,
  with: '',
  group: '',
  body: -1,
  part: '',
  min_s: 0,
  order: 'time',
  isDescending: false,
};

/** Returns what a contact is with: an obstacle, a robot, or people only. */
function otherOf(run: Run, {a, b}: {a: number; b: number}): Other {
  if (b >= run.avatars) return 'obstacles';
  return isPerson(run, a) && isPerson(run, b) ? 'people' : 'robots';
}

function groupOf(run: Run, body: number): string {
  return body < run.avatars ? (run.groups[run.groupOfAvatar[body]] ?? '') : '';
}

/** Returns whether the filter names people, so that the others fade. */
export function choosesPeople(filter: Filter): boolean {
  return filter.group !== '' || filter.body >= 0 || filter.with === 'robots';
}

/** Returns whether a person or robot is one that the filter names. */
export function choosesPerson(run: Run, filter: Filter, id: number): boolean {
  if (filter.body >= 0) return filter.body === id;
  if (filter.group !== '') return groupOf(run, id) === filter.group;
  return filter.with !== 'robots' || !isPerson(run, id);
}

/** The bodies and parts of a contact. */
export type Bodies = Pick<Contact, 'a' | 'b' | 'partA' | 'partB'>;

/** Returns whether a contact matches in all but its length. */
export function matches(run: Run, filter: Filter, contact: Bodies): boolean {
  const {a, b} = contact;
  if (filter.body >= 0 && a !== filter.body && b !== filter.body) return false;
  if (filter.group !== '' && groupOf(run, a) !== filter.group && groupOf(run, b) !== filter.group) return false;
  if (filter.with !== '' && otherOf(run, contact) !== filter.with) return false;
  if (filter.part === '' || !filter.ofParts) return true;
  return partNameOf(run, a, contact.partA) === filter.part || partNameOf(run, b, contact.partB) === filter.part;
}

/** Returns the matching contacts in the order of their begin. */
export function matching(run: Run, filter: Filter, log: ContactLog): Contact[] {
  const min_frames = filter.min_s / run.step_s - 1e-6;
  return (filter.ofParts ? log.ofParts : log.ofBodies).filter(
    (contact) => log.frames(contact) >= min_frames && matches(run, filter, contact),
  );
}

/** Returns the matching contacts in the filter's order; equal ones by time, then by bodies. */
export function select(run: Run, filter: Filter, log: ContactLog): Contact[] {
  const inTime = (p: Contact, q: Contact): number =>
    p.begin - q.begin || p.a - q.a || p.b - q.b || p.partA - q.partA || p.partB - q.partB;
  const by: Record<Order, (p: Contact, q: Contact) => number> = {
    time: inTime,
    length: (p, q) => log.frames(p) - log.frames(q),
    who: (p, q) => p.a - q.a || p.b - q.b,
  };
  const sign = filter.isDescending ? -1 : 1;
  const compare = by[filter.order];
  return matching(run, filter, log).sort((p, q) => sign * compare(p, q) || inTime(p, q));
}

/** Counts contacts of parts by the parts of people and robots, most first; a contact counts for both bodies. */
export function countsByPart(run: Run, filter: Filter, log: ContactLog): [string, number][] {
  const counts = new Map<string, number>();
  for (const {a, b, partA, partB} of matching(run, {...filter, ofParts: true}, log))
    for (const name of [partNameOf(run, a, partA), partNameOf(run, b, partB)])
      if (name !== '') counts.set(name, (counts.get(name) ?? 0) + 1);
  return [...counts].sort(([p, m], [q, n]) => n - m || p.localeCompare(q));
}

/** Returns the names of all parts of the run's models, in their order. */
export function partNames(run: Run): string[] {
  const names = new Set<string>();
  for (const model of run.models) for (const part of model.parts) names.add(displayName(part.name));
  return [...names];
}
