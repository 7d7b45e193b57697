// Helpers for the document and the notices of the page. Text is set as text, never as markup.

export function el<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found as T;
}

export function setText(target: HTMLElement, text: string): void {
  if (target.textContent !== text) target.textContent = text;
}

type Child = Node | string;

export function make(tag: string, attributes: Record<string, string> = {}, ...children: Child[]): HTMLElement {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/** Returns a row of the help: keys and their action. */
export function keyRow(keys: string[], about: string): HTMLElement {
  const cell = make('td');
  keys.forEach((key, i) => {
    if (i > 0) cell.append(' ');
    cell.append(make('kbd', {}, key));
  });
  return make('tr', {}, cell, make('td', {}, about));
}

const WHOLE = new Intl.NumberFormat('en');

export function thousands(value: number): string {
  return WHOLE.format(Math.round(value)).replaceAll(',', '\u202f');
}

/** Returns a number with its noun: "1 pair", "2 pairs". */
export function counted(value: number, noun: string, plural = `${noun}s`): string {
  return `${thousands(value)} ${nounOf(value, noun, plural)}`;
}

/** Returns the noun alone, where the number stands elsewhere. */
export function nounOf(value: number, noun: string, plural = `${noun}s`): string {
  return Math.round(value) === 1 ? noun : plural;
}

/** Shows the pane of a tab: #NAMETab and #NAMEPane. */
export function selectTab<Name extends string>(names: readonly Name[], shown: Name): void {
  for (const name of names) {
    el(`${name}Pane`).hidden = name !== shown;
    el(`${name}Tab`).setAttribute('aria-selected', String(name === shown));
    el(`${name}Tab`).tabIndex = name === shown ? 0 : -1;
  }
}

/** Tabs react to clicks and arrow keys. */
export function bindTabs<Name extends string>(names: readonly Name[], show: (name: Name) => void): void {
  names.forEach((name, index) => {
    el(`${name}Tab`).onclick = () => show(name);
    el(`${name}Tab`).onkeydown = (event) => {
      const move = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
      if (move === 0) return;
      event.stopPropagation();
      const next = names[(index + move + names.length) % names.length];
      show(next);
      el(`${next}Tab`).focus();
    };
  });
}

// Notices report waiting, errors and missing parts of a run.
// Invariant: a repeated notice is not shown again; a screen reader reads it once.

/** Shows a notice in the middle, or at the top while the page shows a run; an empty title hides it. */
export function showNotice(title: string, detail: string, isOverRun: boolean, retry?: () => void): void {
  const box = el('notice');
  const text = `${title}\n${detail}`;
  if (box.dataset.text === text) return;
  box.dataset.text = text;
  box.hidden = title === '';
  box.classList.toggle('top', isOverRun);
  box.replaceChildren(title, ...(detail ? [make('small', {}, detail)] : []));
  if (!retry) return;
  const button = make('button', {}, 'Try again');
  button.onclick = retry;
  box.append(button);
}

/** Shows a banner that stays until it is closed. */
export function showProblem(problem: string): void {
  if (el('problem').textContent === problem) return;
  setText(el('problem'), problem);
  el('banner').hidden = problem === '';
}
