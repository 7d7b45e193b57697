// ContactLog holds the contacts of a run: of two parts, and of two bodies.
// Invariant: a contact of two bodies lasts as long as any of their parts touch, as in contacts.csv.
import type {ContactChange} from './protocol.ts';

export interface Contact {
  a: number;
  b: number;
  /** Parts of a and b; of two bodies: the parts that touched first. */
  partA: number;
  partB: number;
  /** First frame; of contacts that began before it, the first one known. */
  begin: number;
  /** The frame after the last one; -1 while it lasts. */
  end: number;
  /** Whether the begin is before `begin`. */
  isOlder: boolean;
  /** Whether messages are missing: the end is unknown. */
  isLost: boolean;
  /** Number of contacts of parts during it; 1 for parts. */
  parts: number;
  /** Where it began: the middle between both people. */
  x_m: number;
  y_m: number;
}

interface PairState {
  bodies: Contact;
  open: Map<number, Contact>; // by parts
}

const BODIES = 2 ** 26;

export class ContactLog {
  readonly ofParts: Contact[] = [];
  readonly ofBodies: Contact[] = [];
  /** The newest frame that the contacts cover. */
  lastFrame = -1;
  /** Grows with every change. */
  version = 0;
  private readonly pairs = new Map<number, PairState>();

  clear(): void {
    this.ofParts.length = this.ofBodies.length = 0;
    this.pairs.clear();
    this.lastFrame = -1;
    ++this.version;
  }

  /** Takes changes in the order of their frames. */
  take(changes: Iterable<ContactChange>, lastFrame: number): void {
    for (const change of changes) {
      if (change.kind === 'began') this.begin(change);
      else this.end(change);
    }
    this.lastFrame = Math.max(this.lastFrame, lastFrame);
    ++this.version;
  }

  private begin({frame, began, a, b, partA, partB, x_m, y_m}: ContactChange): void {
    const isOlder = began < 0;
    const contact: Contact = {a, b, partA, partB, begin: frame, end: -1, isOlder, isLost: false, parts: 1, x_m, y_m};
    this.ofParts.push(contact);
    const key = a * BODIES + b;
    let state = this.pairs.get(key);
    // Another pair of parts may begin in the frame in which the last one ends.
    const continues = state && (state.open.size > 0 || (state.bodies.end === frame && !state.bodies.isLost));
    if (state && continues) {
      state.bodies.end = -1;
      ++state.bodies.parts;
    } else {
      const bodies = {...contact};
      this.ofBodies.push(bodies);
      if (state) state.bodies = bodies;
      else this.pairs.set(key, (state = {bodies, open: new Map()}));
    }
    state.open.set(partA * 256 + partB, contact);
  }

  private end({frame, a, b, partA, partB, kind}: ContactChange): void {
    const state = this.pairs.get(a * BODIES + b);
    const contact = state?.open.get(partA * 256 + partB);
    if (!state || !contact) return;
    state.open.delete(partA * 256 + partB);
    contact.end = frame;
    contact.isLost = kind === 'lost';
    if (state.open.size > 0) return;
    state.bodies.end = frame;
    state.bodies.isLost = contact.isLost;
  }

  /** Forgets contacts that ended before a frame. */
  forget(frame: number): void {
    const isKept = (contact: Contact): boolean => contact.end < 0 || contact.end >= frame;
    for (const list of [this.ofParts, this.ofBodies]) {
      const kept = list.filter(isKept);
      if (kept.length === list.length) continue;
      list.length = 0;
      for (const contact of kept) list.push(contact);
      ++this.version;
    }
  }

  /** Number of frames; of a contact that lasts, up to the newest frame. */
  frames(contact: Contact): number {
    return (contact.end < 0 ? this.lastFrame + 1 : contact.end) - contact.begin;
  }
}
