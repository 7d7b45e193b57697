// Notices say what the page waits for, what went wrong, and what of a recorded run is missing.
// Invariant: what is said again is not shown again, so that a screen reader hears it once.
import {el, make, setText} from './dom.ts';

/** In the middle of the page, or at its top while it shows a run; an empty title takes it away. */
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

/** A banner that stays until it is closed. */
export function showProblem(problem: string): void {
  if (el('problem').textContent === problem) return;
  setText(el('problem'), problem);
  el('banner').hidden = problem === '';
}
