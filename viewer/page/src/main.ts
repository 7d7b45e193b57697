// Page connects source, stage, panel and input. Live runs, logs and recordings differ in the timeline only.
import {Raycaster, Vector2} from 'three';
import {Card} from './card.ts';
import {Chart, type ChartStyle} from './chart.ts';
import type {Layer} from './crowd.ts';
import {counted, el, keyRow, make, nounOf, setText, showNotice, showProblem, thousands} from './dom.ts';
import {pick, poseOf} from './picking.ts';
import {clock, SPEEDS} from './playback.ts';
import {nameOf, pairAt, personOf, type Frame, type Run} from './protocol.ts';
import {inflated, Replay} from './replay.ts';
import {FileSource, ServerSource, type Series, type Source} from './sources.ts';
import {Stage} from './stage.ts';
import {MARKS, type ThemeName} from './theme.ts';

const LAYER_ROWS: [Layer, string, string, boolean][] = [
  ['meshes', 'Bodies', '1', true],
  ['spheres', 'Avatar spheres', '2', false],
  ['hulls', 'or-DOPs of parts', '3', false],
  ['boxes', 'AABBs of parts', '4', false],
  ['shadows', 'Shadows', '5', true],
  ['tint', 'Tint candidates', '6', true],
];

const KEYS: [string[], string][] = [
  [['Space'], 'play or pause; hold a live picture'],
  [['←', '→'], 'one frame back or forward; with Shift, one second'],
  [['↑', '↓'], 'faster or slower'],
  [['Home', 'End'], 'to the first or last frame'],
  [['1', '…', '6'], 'layers'],
  [['F'], 'follow the selected person'],
  [['R'], 'the whole scene'],
  [['L'], 'layers and charts'],
  [['T'], 'light or dark'],
  [['Esc'], 'clear the selection'],
];

const HISTORY_MS = 700;
const PANEL_MS = 120;
const FPS_MS = 500;

/** Same width as in the style sheet. */
const isNarrow = (): boolean => innerWidth <= 720;

class Page {
  private readonly stage = new Stage(el<HTMLCanvasElement>('stage'));
  private readonly card = new Card((id) => this.choose(id));
  private readonly pairChart = new Chart(el<HTMLCanvasElement>('pairChart'));
  private readonly timeChart = new Chart(el<HTMLCanvasElement>('timeChart'));
  private readonly scrubChart = new Chart(el<HTMLCanvasElement>('scrubChart'));
  private readonly layers = new Map<Layer, HTMLInputElement>();
  private source: Source | null = null;
  private run: Run | null = null;
  private frame: Frame | null = null;
  private series: Series | null = null;
  private paused = false;
  private isScrubbing = false;
  private lastTick = 0;
  private fps = 0;
  private fpsAt = 0;
  private pictures = 0;
  private historyAt = 0;
  private historyOf = '';
  private panelAt = 0;
  private isPanelOld = true;
  private frames = 0;

  constructor() {
    this.buildLayers();
    this.buildLegend();
    this.bindTimeline();
    this.bindPointer();
    el('keys').append(...KEYS.map(([keys, about]) => keyRow(keys, about)));
    el('panelButton').onclick = () => this.togglePanel();
    el('themeButton').onclick = () => this.setTheme(this.theme === 'dark' ? 'light' : 'dark');
    el('helpButton').onclick = () => el<HTMLDialogElement>('help').showModal();
    el('closeCard').onclick = () => this.choose(-1);
    el('closeBanner').onclick = () => (el('banner').hidden = true);
    el('follow').onclick = () => this.toggleFollow();
    el('livePause').onclick = () => this.togglePaused();
    addEventListener('keydown', (event) => this.key(event));
    addEventListener('resize', () => this.resize());
    for (const type of ['keydown', 'click', 'input']) addEventListener(type, () => (this.isPanelOld = true), true);
    const dark = matchMedia('(prefers-color-scheme: dark)');
    dark.addEventListener('change', () => this.setTheme(dark.matches ? 'dark' : 'light'));
    this.setTheme(dark.matches ? 'dark' : 'light');
    this.togglePanel(!isNarrow());
    this.resize();
    requestAnimationFrame((now) => this.tick(now));
  }

  async open(): Promise<void> {
    const events = {
      run: (run: Run) => this.setRun(run),
      frame: (frame: Frame) => this.take(frame),
      series: (series: Series) => {
        this.series = series;
        showProblem(series.problem);
        this.isPanelOld = true;
      },
      history: (id: number, past: any[]) => {
        if (id === this.card.id) this.card.setHistory(past as any);
        this.isPanelOld = true;
      },
      notice: (title: string, detail?: string, retry?: () => void) => this.notice(title, detail, retry),
    };
    const recording = document.getElementById('recording');
    if (recording) {
      const replay = new Replay(await inflated(recording.textContent ?? ''));
      recording.remove();
      this.source = new FileSource(replay, events);
    } else {
      this.source = new ServerSource(`ws://${location.host}/ws`, events);
    }
  }

  // Incoming data

  private setRun(run: Run): void {
    const isNew = this.run?.run_id !== run.run_id;
    this.run = run;
    this.stage.setRun(run);
    this.stage.setTheme(this.theme);
    for (const [layer, box] of this.layers) this.stage.show(layer, box.checked);
    setText(el('scene'), run.scene);
    document.title = `${run.scene} – Throng`;
    this.updateMode();
    el('timeline').hidden = run.mode === 'live';
    el('pauseBar').hidden = run.mode !== 'live';
    this.historyOf = '';
    if (isNew) this.choose(-1);
    this.notice('');
    this.frame = null;
  }

  private take(frame: Frame): void {
    if (this.paused && this.frame) return;
    this.frame = frame;
    ++this.frames;
    this.stage.take(frame);
    this.updateCard();
  }

  private notice(title: string, detail = '', retry?: () => void): void {
    this.updateMode(title !== '');
    showNotice(title, detail, this.run !== null, retry);
  }

  private updateMode(isStale = false): void {
    const mode = this.run?.mode;
    const isEnded = this.source?.isEnded ?? false;
    const names = {live: isEnded ? 'FINISHED' : 'LIVE', log: 'LOG', file: 'REPLAY'};
    setText(el('mode'), mode ? names[mode] : '');
    el('mode').classList.toggle('live', mode === 'live' && !isEnded);
    el('mode').classList.toggle('stale', mode === 'live' && !isEnded && isStale);
  }

  // Animation loop

  private tick(now: number): void {
    const dt_ms = this.lastTick ? now - this.lastTick : 16;
    this.lastTick = now;
    this.source?.tick(this.isScrubbing ? 0 : dt_ms / 1000);
    if (this.stage.render(this.frame, dt_ms)) {
      ++this.pictures;
      this.isPanelOld = true;
    }
    if (now > this.panelAt) {
      this.panelAt = now + PANEL_MS;
      this.countPictures(now);
      if (this.isPanelOld) this.updatePanel(now);
    }
    requestAnimationFrame((next) => this.tick(next));
  }

  /** An unchanged picture is not drawn again; without drawing there is no frame rate to show. */
  private countPictures(now: number): void {
    if (now - this.fpsAt < FPS_MS) return;
    this.fps = (1000 * this.pictures) / (now - this.fpsAt);
    this.fpsAt = now;
    this.pictures = 0;
    setText(el('fps'), this.fps > 0 ? String(Math.max(1, Math.round(this.fps))) : '–');
  }

  private updatePanel(now: number): void {
    const {frame, run, source} = this;
    this.isPanelOld = false;
    if (!frame || !run || !source) return;
    setText(el('people'), thousands(frame.present));
    setText(el('peopleNoun'), nounOf(frame.present, 'person', 'people'));
    setText(el('pairs'), thousands(frame.pairs));
    setText(el('pairsNoun'), nounOf(frame.pairs, 'pair'));
    setText(el('liveClock'), clock(frame.time_s));
    el('drops').hidden = source.dropped === 0;
    setText(el('drops'), `${thousands(source.dropped)} dropped`);
    el('lost').hidden = frame.lost === 0;
    setText(el('lost'), `${thousands(frame.lost)} lost`);
    this.updateLegend(frame);
    this.updateTimeline();
    this.drawCharts();
    this.requestHistory(now, frame, source);
    this.updateCard();
    this.updateFacts(frame, run);
  }

  /** Requests the history of each frame that rests on the screen, and regularly while playing. */
  private requestHistory(now: number, frame: Frame, source: Source): void {
    const requested = `${this.card.id} ${frame.number}`;
    if (this.card.id < 0 || requested === this.historyOf) return;
    if (now < this.historyAt) {
      this.isPanelOld = true;
      return;
    }
    this.historyAt = now + HISTORY_MS;
    this.historyOf = requested;
    source.requestHistory(this.card.id, frame.number);
  }

  private updateCard(): void {
    if (this.run && this.frame) this.card.update(this.run, this.frame);
  }

  private updateFacts(frame: Frame, run: Run): void {
    const {calls, triangles} = this.stage.drawn;
    const lines = [
      `${counted(run.firstPart[run.avatars], 'body part')}, ${run.part_volume}${run.exact ? ', exact' : ''}`,
      `${counted(triangles, 'triangle')} in ${counted(calls, 'call')}`,
    ];
    if (frame.build_ms > 0) lines.push(`server ${frame.build_ms.toFixed(1)} ms per frame`);
    if (this.source instanceof ServerSource) lines.push(`page ${this.source.decode_ms.toFixed(2)} ms to decode`);
    setText(el('facts'), lines.join('\n'));
  }

  private chartStyle(): ChartStyle {
    const style = getComputedStyle(document.documentElement);
    const value = (name: string): string => style.getPropertyValue(name).trim();
    return {line: value('--chart'), fill: value('--chartFill'), text: value('--faint'), cursor: value('--text')};
  }

  private drawCharts(): void {
    const {series, source} = this;
    if (!series) return;
    const style = this.chartStyle();
    const playback = source?.playback;
    const cursor = playback && playback.last > 0 ? playback.position / playback.last : -1;
    this.pairChart.draw(series.pairs, (pairs) => counted(pairs, 'pair'), style, cursor);
    const hasTimes = Array.prototype.some.call(series.frame_ms, (ms: number) => ms > 0);
    el('timeChartBox').hidden = !hasTimes;
    if (hasTimes) this.timeChart.draw(series.frame_ms, (ms) => `${ms} ms`, style, cursor);
    if (playback) this.scrubChart.draw(series.pairs, () => '', style);
  }

  // Layers and legend

  private buildLayers(): void {
    for (const [layer, title, key, on] of LAYER_ROWS) {
      const box = make('input', {type: 'checkbox', role: 'switch', id: `layer-${layer}`}) as HTMLInputElement;
      box.checked = on;
      box.onchange = () => this.stage.show(layer, box.checked);
      this.layers.set(layer, box);
      el('layers').append(make('label', {class: 'layer'}, make('span', {}, title), make('kbd', {}, key), box));
    }
  }

  private toggleLayer(layer: Layer): void {
    const box = this.layers.get(layer)!;
    box.checked = !box.checked;
    this.stage.show(layer, box.checked);
  }

  private buildLegend(): void {
    MARKS.forEach((mark, index) => {
      const row = make('li', {id: `mark-${index}`}, make('i', {style: `background:${mark.color}`}), make('span', {}, mark.name), make('output', {}), make('small', {}, mark.about));
      el('legend').append(row);
    });
  }

  /** Hides levels that do not occur in this run. */
  private updateLegend(frame: Frame): void {
    const counts = [frame.crowded, 0, 0, 0, 0];
    for (let i = 0; i < frame.pairs; ++i) ++counts[pairAt(frame, i).level + 1];
    const decided = this.run!.exact ? 4 : 3;
    counts.forEach((count, index) => {
      const row = el(`mark-${index}`);
      row.hidden = index > 0 && index !== decided && count === 0;
      setText(row.querySelector('output')!, thousands(count));
    });
  }

  // Time

  private bindTimeline(): void {
    const scrub = el<HTMLInputElement>('scrub');
    scrub.oninput = () => this.source?.playback?.seek(Number(scrub.value));
    scrub.onpointerdown = () => (this.isScrubbing = true);
    addEventListener('pointerup', () => (this.isScrubbing = false));
    el('play').onclick = () => this.source?.playback?.toggle();
    el('stepBack').onclick = () => this.source?.playback?.step(-1);
    el('stepOn').onclick = () => this.source?.playback?.step(1);
    el('speed').onclick = () => {
      const playback = this.source?.playback;
      if (playback) playback.speed = SPEEDS[(SPEEDS.indexOf(playback.speed) + 1) % SPEEDS.length];
    };
  }

  private updateTimeline(): void {
    const playback = this.source?.playback;
    if (!playback) return;
    const scrub = el<HTMLInputElement>('scrub');
    scrub.min = String(playback.first);
    scrub.max = String(playback.last);
    if (!this.isScrubbing) scrub.value = String(playback.frame);
    scrub.setAttribute('aria-valuetext', `frame ${playback.frame} of ${playback.last}`);
    setText(el('play'), playback.playing ? '❚❚' : '▶');
    setText(el('speed'), `${playback.speed}×`);
    el('clock').replaceChildren(
      make('b', {}, clock(playback.time_s)),
      make('span', {class: 'total'}, ` / ${clock(playback.last * playback.step_s)}`),
    );
  }

  private togglePaused(): void {
    this.paused = !this.paused;
    el('livePause').setAttribute('aria-pressed', String(this.paused));
    setText(el('livePause'), this.paused ? '▶ Resume' : '❚❚ Hold');
  }

  // People

  private bindPointer(): void {
    const canvas = el<HTMLCanvasElement>('stage');
    let down = [0, 0, 0];
    canvas.addEventListener('pointerdown', (event) => {
      down = [event.clientX, event.clientY, performance.now()];
      canvas.focus({preventScroll: true});
    });
    canvas.addEventListener('pointerup', (event) => {
      const moved = Math.hypot(event.clientX - down[0], event.clientY - down[1]);
      if (moved > 6 || performance.now() - down[2] > 600 || event.button !== 0) return;
      this.pickAt(event.clientX, event.clientY, event.pointerType === 'touch' ? 0.12 : 0.03);
    });
    canvas.addEventListener('dblclick', () => this.card.id >= 0 && this.toggleFollow());
  }

  private pickAt(x: number, y: number, slack_m: number): void {
    if (!this.run || !this.frame) return;
    const caster = new Raycaster();
    caster.setFromCamera(new Vector2((2 * x) / innerWidth - 1, 1 - (2 * y) / innerHeight), this.stage.camera);
    this.choose(pick(this.run, this.frame, caster.ray, slack_m));
  }

  private choose(id: number): void {
    this.historyAt = 0;
    this.historyOf = '';
    this.isPanelOld = true;
    this.stage.select(id);
    if (id < 0 || !this.run) {
      this.card.close();
      this.follow(-1);
      return;
    }
    if (isNarrow()) this.togglePanel(false);
    this.card.open(this.run, id);
    this.updateCard();
    if (this.stage.followed >= 0) this.follow(id);
  }

  private toggleFollow(): void {
    this.follow(this.stage.followed < 0 ? this.card.id : -1);
  }

  private follow(id: number): void {
    this.stage.followed = id;
    el('follow').setAttribute('aria-pressed', String(id >= 0));
    if (id < 0 || !this.run || !this.frame) return;
    const height_m = this.run.models[this.run.modelOfAvatar[id]].height_m * this.run.scaleOfAvatar[id];
    this.stage.approach(personOf(this.frame, id).position_m, height_m);
  }

  // Theme, panel and keys

  private get theme(): ThemeName {
    return document.documentElement.dataset.theme === 'dark' ? 'dark' : 'light';
  }

  private setTheme(name: ThemeName): void {
    document.documentElement.dataset.theme = name;
    this.stage.setTheme(name);
  }

  private togglePanel(open = el('panel').classList.contains('closed')): void {
    el('panel').classList.toggle('closed', !open);
    el('panelButton').setAttribute('aria-expanded', String(open));
    // On a phone the panel covers the card.
    el('card').classList.toggle('covered', open && isNarrow());
  }

  private resize(): void {
    this.stage.resize(innerWidth, innerHeight);
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || el<HTMLDialogElement>('help').open) return;
    const onButton = event.target instanceof HTMLButtonElement && (event.key === ' ' || event.key === 'Enter');
    if (onButton) return;
    const playback = this.source?.playback;
    const far = event.shiftKey && playback ? Math.round(1 / playback.step_s) : 1;
    const layer = LAYER_ROWS.find(([, , key]) => key === event.key);
    const actions: Record<string, () => void> = {
      ' ': () => (playback ? playback.toggle() : this.togglePaused()),
      arrowleft: () => playback?.step(-far),
      arrowright: () => playback?.step(far),
      arrowup: () => playback?.change(1),
      arrowdown: () => playback?.change(-1),
      home: () => playback?.seek(0),
      end: () => playback?.seek(playback.last),
      f: () => this.card.id >= 0 && this.toggleFollow(),
      r: () => {
        this.follow(-1);
        this.stage.overview();
      },
      l: () => this.togglePanel(),
      t: () => this.setTheme(this.theme === 'dark' ? 'light' : 'dark'),
      '?': () => el<HTMLDialogElement>('help').showModal(),
      h: () => el<HTMLDialogElement>('help').showModal(),
      escape: () => this.choose(-1),
    };
    const action = layer ? () => this.toggleLayer(layer[0]) : actions[event.key.toLowerCase()];
    if (!action) return;
    event.preventDefault();
    action();
  }

  /** Returns the present state of the page, for tests and scripts. */
  state(): object {
    const {run, frame, source} = this;
    return {
      mode: run?.mode ?? '',
      avatars: run?.avatars ?? 0,
      frame: frame?.number ?? -1,
      frames: this.frames,
      time_s: frame?.time_s ?? 0,
      pairs: frame?.pairs ?? 0,
      isEnded: source?.isEnded ?? false,
      problem: this.series?.problem ?? '',
      selected: this.card.id,
      selectedName: run && this.card.id >= 0 ? nameOf(run, this.card.id) : '',
      dropped: source?.dropped ?? 0,
      decode_ms: source instanceof ServerSource ? source.decode_ms : 0,
      build_ms: frame?.build_ms ?? 0,
      fps: this.fps,
      drawn: this.stage.drawn,
    };
  }

  /** Returns the pixel position of a person's chest; null outside the picture. */
  screenPosition(id: number): [number, number] | null {
    if (!this.frame || !this.run) return null;
    const [x, y, z] = personOf(this.frame, id).position_m;
    const p = this.stage.project(x, y, z + 0.7 * this.run.models[this.run.modelOfAvatar[id]].height_m * this.run.scaleOfAvatar[id]);
    return Math.abs(p[0]) < 1 && Math.abs(p[1]) < 1 ? [((p[0] + 1) / 2) * innerWidth, ((1 - p[1]) / 2) * innerHeight] : null;
  }

  /** Returns x, y, z of every part of every person, in world coordinates. */
  partPositions(): number[] {
    const {run, frame} = this;
    if (!run || !frame) return [];
    const out: number[] = [];
    for (let id = 0; id < run.avatars; ++id)
      for (let part = 0; part < run.firstPart[id + 1] - run.firstPart[id]; ++part)
        out.push(...poseOf(run, frame, id, part).origin.toArray());
    return out;
  }

  positionOf(id: number): number[] {
    return this.frame ? personOf(this.frame, id).position_m : [];
  }
}

const page = new Page();
Object.assign(window, {throng: page});
page.open().catch((error: Error) => {
  const box = el('notice');
  box.hidden = false;
  box.replaceChildren('This recording cannot be shown', make('small', {}, error.message));
});
