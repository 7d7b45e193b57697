// Page connects source, stage, panel and input. Live runs, logs and recordings differ in the timeline only.
import {Raycaster, Vector2, Vector3} from 'three';
import {Card} from './card.ts';
import {Chart, type ChartStyle} from './chart.ts';
import type {Contact} from './contacts.ts';
import {ContactsPanel} from './contacts_panel.ts';
import {bindTabs, counted, el, keyRow, make, nounOf, selectTab, setText, showNotice, showProblem, thousands} from './dom.ts';
import {choosesPeople, choosesPerson, countsByPart, type Bodies} from './filter.ts';
import {Finder, type Finding} from './find.ts';
import {CHEST, heightOf, pointOf} from './framing.ts';
import {readLink, renderCommand, withTheme, writeLink, type PageView} from './link.ts';
import {pick, poseOf} from './picking.ts';
import {MAX_CLOSEST, ProximityPanel} from './proximity_panel.ts';
import {clock, SPEEDS, whenOf} from './playback.ts';
import {displayName, isPresent, nameOf, pairAt, personOf, type Frame, type ProximityRow, type Run, type Shortfall} from './protocol.ts';
import {inflated, Replay} from './replay.ts';
import {FileSource, ServerSource, socketUrl, type Series, type Source} from './sources.ts';
import {Stage} from './stage.ts';
import type {ThemeName} from './theme.ts';
import {VideoPanel, type Filmed} from './video.ts';
import {ViewPane} from './view_pane.ts';

const KEYS: [string[], string][] = [
  [['Space'], 'play or pause; hold a live picture'],
  [['←', '→'], 'one frame back or forward; with Shift, one second'],
  [['↑', '↓'], 'faster or slower'],
  [['Home', 'End'], 'to the first or last frame'],
  [['1', '…', '6'], 'layers'],
  [['/'], 'find a person, group, robot or obstacle'],
  [['N', 'P'], 'next or previous contact of the list'],
  [['F'], 'follow the selected person'],
  [['R', 'V'], 'the whole scene; from above and back'],
  [['W', 'A', 'S', 'D'], 'turn the view; with Shift, move it'],
  [['+', '−'], 'nearer or further'],
  [['L', 'K'], 'the panel; copy a link to this view'],
  [['T'], 'light or dark'],
  [['Esc'], 'clear the selection'],
];

/** Directions of the keys that turn and move the view: right, up. */
const WAYS: Record<string, [number, number]> = {w: [0, 1], a: [-1, 0], s: [0, -1], d: [1, 0]};
const TURN_RAD = Math.PI / 36;
const MOVE = 0.06;
const ZOOM = 0.88;
const HISTORY_MS = 700;
const PANEL_MS = 120;
const FPS_MS = 500;
const LINK_MS = 1000;
const FRAME_WAIT_MS = 20_000;
const MAX_SHORTFALLS = 100;
const TABS = ['contacts', 'view', 'charts', 'engine'] as const;
type Tab = (typeof TABS)[number];

/** Same width as in the style sheet. */
const isNarrow = (): boolean => innerWidth <= 720;

class Page {
  private readonly stage = new Stage(el<HTMLCanvasElement>('stage'));
  private readonly card = new Card((id) => this.choose(id));
  private readonly contacts = new ContactsPanel((contact) => this.showContact(contact), () => this.refocus());
  private readonly proximity = new ProximityPanel(
    (frame) => this.rest(frame),
    ({frame, other}) => this.showAt(frame, [this.source!.proximity.body, other]),
    (id) => this.choose(id),
    () => (this.isPanelOld = true),
  );
  private readonly finder = new Finder((finding) => this.showFinding(finding));
  private readonly pairChart = this.chart('pairChart');
  private readonly timeChart = this.chart('timeChart');
  private readonly scrubChart = this.chart('scrubChart');
  private readonly look = new ViewPane(this.stage, () => this.recolor());
  private readonly video = new VideoPanel(
    this.stage,
    () => this.filmed(),
    (name, file) => saveFile(name, file),
    (error) => this.notice('No video', error.message),
  );
  private source: Source | null = null;
  private run: Run | null = null;
  private frame: Frame | null = null;
  private series: Series | null = null;
  private paused = false;
  private isScrubbing = false;
  /** Whether the focused element was clicked and not reached by keys. */
  private isFocusFromPointer = false;
  private lastTick = 0;
  private fps = 0;
  private fpsAt = 0;
  private pictures = 0;
  private historyAt = 0;
  private historyOf = '';
  private panelAt = 0;
  private isPanelOld = true;
  private frames = 0;
  private selected: number[] = [];
  private contact: Bodies | null = null;
  private focus = '';
  private style: ChartStyle | null = null;
  private counted = '';
  private shortfalls = '';
  private linkAt = 0;
  /** The frame that a link asks for, until it is known; -1: none. */
  private wantedFrame = -1;
  /** Null: that of the system. */
  private chosenTheme: ThemeName | null = null;
  /** What the address asks for, until it is shown. */
  private link: Partial<PageView> | null = readLink(location.hash);

  constructor() {
    bindTabs(TABS, (tab) => this.showTab(tab));
    this.bindTimeline();
    this.bindPointer();
    this.stage.freeRect = freeRect;
    this.stage.marks.accepts = (frame, pair) => this.contacts.shows(pairAt(frame, pair), frame.number);
    el('keys').append(...KEYS.map(([keys, about]) => keyRow(keys, about)));
    el('panelButton').onclick = () => this.togglePanel();
    el('themeButton').onclick = () => this.toggleTheme();
    el('helpButton').onclick = () => el<HTMLDialogElement>('help').showModal();
    el('closeCard').onclick = () => this.choose(-1);
    el('closeBanner').onclick = () => (el('banner').hidden = true);
    el('follow').onclick = () => this.toggleFollow();
    el('livePause').onclick = () => this.togglePaused();
    for (const scale of [1, 2, 4]) el(`picture${scale}`).onclick = () => void this.savePicture(scale);
    el('linkButton').onclick = () => void this.copyLink();
    document.querySelector<HTMLElement>('[data-action=link]')!.onclick = () => void this.copyLink();
    document.querySelector<HTMLElement>('[data-action=theme]')!.onclick = () => el('themeButton').click();
    el('commandButton').onclick = () => void this.copyText(this.renderCommand(), el('commandButton'));
    el('cardContacts').onclick = () => this.listContactsOf(this.card.id);
    addEventListener('hashchange', () => {
      const view = readLink(location.hash);
      if (view.theme) this.chooseTheme(view.theme);
      this.openLink(view);
    });
    let isPointer = false;
    addEventListener('pointerdown', () => (isPointer = true), true);
    addEventListener('keydown', () => (isPointer = false), true);
    addEventListener('focusin', () => (this.isFocusFromPointer = isPointer));
    addEventListener('keydown', (event) => this.key(event));
    addEventListener('resize', () => this.resize());
    for (const type of ['keydown', 'click', 'input']) addEventListener(type, () => (this.isPanelOld = true), true);
    const dark = matchMedia('(prefers-color-scheme: dark)');
    dark.addEventListener('change', () => this.setTheme(this.chosenTheme ?? (dark.matches ? 'dark' : 'light')));
    this.chosenTheme = this.link?.theme ?? null;
    this.setTheme(this.chosenTheme ?? (dark.matches ? 'dark' : 'light'));
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
        this.seekWanted();
        showProblem(series.problem);
        this.isPanelOld = true;
      },
      history: (id: number, past: any[]) => {
        if (id === this.card.id) this.card.setHistory(past as any);
        this.isPanelOld = true;
      },
      density: () => (this.isPanelOld = true),
      proximity: () => {
        this.showDistances();
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
      this.source = new ServerSource(socketUrl(location.href), events);
    }
  }

  // Incoming data

  private setRun(run: Run): void {
    const isNew = this.run?.run_id !== run.run_id;
    this.run = run;
    this.stage.setRun(run);
    this.stage.setTheme(this.theme);
    this.finder.setRun(run);
    this.focus = '';
    if (this.source) this.openContacts(run, this.source);
    this.look.showLayers();
    setText(el('scene'), run.scene);
    document.title = `${run.scene} – Throng`;
    this.updateMode();
    el('timeline').hidden = run.mode === 'live';
    el('pauseBar').hidden = run.mode !== 'live';
    el('videoBox').hidden = run.mode === 'live';
    this.historyOf = '';
    if (isNew) this.choose(-1);
    this.stage.recentre();
    this.notice('');
    this.frame = null;
  }

  private take(frame: Frame): void {
    if (this.paused && this.frame) return;
    const isFirst = this.frame === null;
    this.frame = frame;
    ++this.frames;
    this.stage.take(frame);
    this.recolor();
    this.updateCard();
    this.showDistances();
    if (isFirst && this.link) this.openLink(this.link);
    if (isFirst) this.link = null;
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
    // A film has its own clock, and changes on the page would slow it down.
    if (this.video.isFilming) return void requestAnimationFrame((next) => this.tick(next));
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
    setText(el('liveClock'), clock(frame.time_s));
    el('drops').hidden = source.dropped === 0;
    setText(el('drops'), `${thousands(source.dropped)} dropped`);
    el('lost').hidden = frame.lost === 0;
    setText(el('lost'), `${thousands(frame.lost)} lost`);
    this.look.updateCounts(run, frame);
    this.updateTimeline();
    this.drawCharts();
    this.contacts.update();
    this.markRow(frame);
    this.updateHeat();
    this.updatePartCounts(run, source);
    this.updateCounts(frame, run);
    this.updateFocus();
    this.updateLink(now);
    this.requestHistory(now, frame, source);
    this.updateCard();
    this.proximity.update(run, source.proximity, frame.number, source.playback, this.chartStyle());
    this.updateFacts(frame, run);
  }

  /** Marks the row of the selected pair, as soon as it is listed. */
  private markRow(frame: Frame): void {
    const [a, b] = this.selected;
    if (b === undefined || this.contacts.chosen) return;
    this.contacts.mark(this.contact ?? {a: Math.min(a, b), b: Math.max(a, b), partA: -1, partB: -1}, frame.number);
  }

  /** The counts of the header are those of the filter. */
  private updateCounts(frame: Frame, run: Run): void {
    const {filter} = this.contacts;
    const choosesSome = choosesPeople(filter);
    let people = choosesSome ? 0 : frame.present;
    for (let id = 0; id < run.avatars && choosesSome; ++id)
      if (isPresent(frame, id) && choosesPerson(run, filter, id)) ++people;
    let pairs = 0;
    for (let i = 0; i < frame.pairs; ++i) if (this.contacts.shows(pairAt(frame, i), frame.number)) ++pairs;
    const of = (count: number, all: number): string =>
      count === all ? thousands(all) : `${thousands(count)} of ${thousands(all)}`;
    setText(el('people'), of(people, frame.present));
    setText(el('peopleNoun'), nounOf(frame.present, 'person', 'people'));
    setText(el('pairs'), of(pairs, frame.pairs));
    setText(el('pairsNoun'), nounOf(frame.pairs, 'pair'));
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

  /** Draws lines to the nearest others of the selected body, which do not fade. */
  private showDistances(): void {
    const {source, frame} = this;
    if (!source || !frame) return;
    this.stage.setDistances(source.proximity.body, this.nearest(frame));
    this.updateFocus();
  }

  private nearest(frame: Frame): ProximityRow[] {
    return this.source?.proximity.at(frame.number).slice(0, MAX_CLOSEST) ?? [];
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

  private chart(id: string): Chart {
    return new Chart(el<HTMLCanvasElement>(id), () => (this.isPanelOld = true));
  }

  /** Returns the same object until the theme changes. */
  private chartStyle(): ChartStyle {
    if (this.style) return this.style;
    const style = getComputedStyle(document.documentElement);
    const value = (name: string): string => style.getPropertyValue(name).trim();
    return this.style = {line: value('--chart'), fill: value('--chartFill'), text: value('--faint'), cursor: value('--text')};
  }

  private updatePartCounts(run: Run, source: Source): void {
    if (el('chartsPane').hidden) return;
    const state = JSON.stringify([source.contacts.version, this.contacts.filter]);
    if (state === this.counted) return;
    this.counted = state;
    const counts = countsByPart(run, this.contacts.filter, source.contacts);
    const most = Math.max(1, ...counts.map(([, count]) => count));
    const rows = counts.map(([name, count]) =>
      make('li', {}, name, make('i', {style: `width:${(100 * count) / most}%`}), make('output', {}, thousands(count))),
    );
    el('partCounts').replaceChildren(...rows);
  }

  private async savePicture(scale: number): Promise<void> {
    const {run, frame} = this;
    if (!run || !frame) return;
    try {
      saveFile(`${run.scene}-${frame.number}.png`, await this.stage.picture(scale));
    } catch (error) {
      this.notice('No picture', (error as Error).message);
    }
  }

  /** Live runs cannot be sought. */
  private filmed(): Filmed | null {
    const {run, source} = this;
    const playback = source?.playback;
    if (!run || !playback) return null;
    const show = async (position: number): Promise<void> => {
      playback.seek(position);
      source.tick(0);
      for (const end = performance.now() + FRAME_WAIT_MS; this.frame?.number !== playback.frame; ) {
        if (performance.now() > end) throw new Error(`frame ${playback.frame} does not arrive`);
        await new Promise((done) => setTimeout(done, 1));
      }
      this.updateFocus();
    };
    return {name: `${run.scene}-${playback.frame}`, playback, show};
  }

  private drawCharts(): void {
    const {series, source} = this;
    if (!series) return;
    const style = this.chartStyle();
    const playback = source?.playback;
    const cursor = playback && playback.last > 0 ? playback.position / playback.last : -1;
    // A source passes another series after each change.
    if (this.pairChart.isOld(series, style, cursor))
      this.pairChart.draw(series.pairs, (pairs) => counted(pairs, 'pair'), style, cursor);
    const hasTimes = Array.prototype.some.call(series.frame_ms, (ms: number) => ms > 0);
    el('timeChartBox').hidden = !hasTimes;
    if (hasTimes && this.timeChart.isOld(series, style, cursor))
      this.timeChart.draw(series.frame_ms, (ms) => `${ms} ms`, style, cursor);
    if (playback && this.scrubChart.isOld(series, style, playback.last, playback.frames)) {
      this.scrubChart.draw(series.pairs, () => '', style);
      this.scrubChart.mark(series.shortfalls.map(([begin, end]) => [begin, end < 0 ? playback.frames : end]), playback.last);
    }
    this.listShortfalls(series.shortfalls);
  }

  /** A row shows the begin of its shortfall. */
  private listShortfalls(shortfalls: readonly Shortfall[]): void {
    const {run} = this;
    el('shortfallBox').hidden = shortfalls.length === 0;
    const state = `${run?.run_id} ${shortfalls.length} ${shortfalls.filter(([, end]) => end < 0).length}`;
    if (!run || state === this.shortfalls) return;
    this.shortfalls = state;
    const rows = shortfalls.slice(0, MAX_SHORTFALLS).map(([begin, end, robot, person, region, lack_m]) => {
      const when = whenOf({begin, end, isOlder: false, isLost: false}, this.series?.frames ?? begin, run.step_s);
      const button = make('button', {}, `${nameOf(run, robot)} – ${nameOf(run, person)} ${displayName(region)}, ${when}, ${lack_m.toFixed(2)} m too close`);
      button.onclick = () => {
        this.selectBodies([robot, person]);
        this.showAt(begin, [robot, person]);
      };
      return make('li', {}, button);
    });
    if (shortfalls.length > rows.length) rows.push(make('li', {class: 'none'}, `${thousands(shortfalls.length - rows.length)} more`));
    el('shortfalls').replaceChildren(...rows);
  }

  private recolor(): void {
    const {run, frame, source} = this;
    if (this.look.coloring === 'contacts' || this.look.heat) source?.loadContacts();
    if (!run || !frame || !source) return;
    this.look.updateColors(run, frame, source.contacts);
    this.updateHeat();
  }

  private updateHeat(): void {
    const {run, source} = this;
    if (!run || !source) return;
    const span = this.look.isDensity ? this.look.heat : null;
    if (span) source.loadDensity(Math.floor(span[0] / run.step_s), Math.ceil(span[1] / run.step_s));
    this.look.updateHeat(run, this.contacts.filter, source);
  }

  // Contacts

  private openContacts(run: Run, source: Source): void {
    this.contacts.setRun(run, source.contacts);
    if (!el('contactsPane').hidden) source.loadContacts();
  }

  private showTab(shown: Tab): void {
    selectTab(TABS, shown);
    if (shown !== 'view') this.source?.loadContacts();
    this.isPanelOld = true;
  }

  private listContactsOf(id: number): void {
    this.togglePanel(true);
    this.showTab('contacts');
    this.contacts.set({body: id, order: 'length', isDescending: true});
  }

  /** Selects both bodies of a contact and shows its begin. */
  private showContact(contact: Contact): void {
    this.selectBodies([contact.a, contact.b], this.contacts.filter.ofParts ? contact : null);
    this.follow(-1);
    this.showAt(contact.begin, [contact.a, contact.b]);
  }

  /** Stops at a frame and moves the camera to bodies as soon as it is shown; in a live run, at once. */
  private showAt(frame: number, bodies: number[]): void {
    this.rest(frame);
    if (this.source?.playback) this.whenFrame(frame, () => this.lookAt(bodies));
    else this.lookAt(bodies);
  }

  /** Stops at a frame of a recorded run. */
  private rest(frame: number): void {
    const {source} = this;
    if (!source?.playback) return;
    source.playback.playing = false;
    source.playback.seek(frame);
    source.tick(0);
    this.isPanelOld = true;
  }

  /** Calls `then` as soon as a frame is shown. */
  private whenFrame(number: number, then: () => void, tries = 200): void {
    if (this.frame?.number === number) return then();
    if (tries > 0) setTimeout(() => this.whenFrame(number, then, tries - 1), 25);
  }

  private lookAt(bodies: number[]): void {
    const {run, frame} = this;
    if (!run || !frame) return;
    const points = bodies
      .filter((body) => body < run.avatars && isPresent(frame, body))
      .flatMap((body) => [pointOf(run, frame, body, 0), pointOf(run, frame, body, 1)]);
    if (points.length > 0) this.stage.showBodies(points);
  }

  /** An unchanged picture is not drawn again. */
  private updateFocus(): void {
    const {run, frame} = this;
    if (!run || !frame) return;
    const focus = this.focusOf(run, frame);
    const state = focus ? focus.join('') : '';
    if (state === this.focus) return;
    this.focus = state;
    this.stage.setFocus(focus);
  }

  /** People outside the filter fade, and while the picture rests those without a contact; null: none does. */
  private focusOf(run: Run, frame: Frame): Uint8Array | null {
    const {filter} = this.contacts;
    const isPlaying = this.source?.playback ? this.source.playback.playing : !this.paused;
    const isResting = !isPlaying && !this.video.isFilming;
    const choosesSome = choosesPeople(filter);
    if (!isResting && !choosesSome) return null;
    const flags = new Uint8Array(run.avatars);
    for (let i = 0; i < frame.pairs; ++i) {
      const pair = pairAt(frame, i);
      if (!this.contacts.shows(pair, frame.number)) continue;
      flags[pair.a] = 1;
      if (pair.b < run.avatars) flags[pair.b] = 1;
    }
    // The people that a filter names stay, also without a contact.
    for (let id = 0; id < run.avatars && choosesSome; ++id) if (choosesPerson(run, filter, id)) flags[id] = 1;
    for (const id of this.selected) if (id < run.avatars) flags[id] = 1;
    for (const {other} of this.nearest(frame)) if (other < run.avatars) flags[other] = 1;
    return flags;
  }

  private refocus(): void {
    this.isPanelOld = true;
    this.stage.select(...this.selected); // draws the marks of the filter
    this.updateFocus();
  }

  private showFinding(finding: Finding): void {
    if ('group' in finding) {
      this.togglePanel(true);
      this.showTab('contacts');
      return this.contacts.set({group: finding.group, body: -1});
    }
    const {run, frame} = this;
    if (!run || !frame) return;
    if (finding.body >= run.avatars) {
      this.selectBodies([finding.body]);
      this.listContactsOf(finding.body);
      const [x, y] = run.obstacles[finding.body - run.avatars].centre_m;
      return this.stage.showBodies([new Vector3(x, y, 0), new Vector3(x, y, 2)]);
    }
    this.choose(finding.body);
    this.lookAt([finding.body]);
  }

  // Links

  private view(): PageView {
    const {position} = this.stage.camera;
    return {
      frame: this.source?.playback?.frame ?? null,
      selected: this.selected,
      parts: this.contact ? [this.contact.partA, this.contact.partB] : [],
      isFollowing: this.stage.followed >= 0,
      tab: TABS.find((tab) => !el(`${tab}Pane`).hidden)!,
      camera: [...position.toArray(), ...this.stage.controls.target.toArray()],
      layers: this.look.layers,
      coloring: this.look.coloring,
      heat: this.look.heat,
      isDensity: this.look.isDensity,
      filter: this.contacts.filter,
      theme: this.chosenTheme,
    };
  }

  /** Returns the text of a link to this view, after "#". */
  linkText(): string {
    return writeLink(this.view());
  }

  private openLink(view: Partial<PageView>): void {
    const playback = this.source?.playback;
    if (view.layers) this.look.showLayers(view.layers);
    if (view.coloring) this.look.setColoring(view.coloring);
    if (view.heat !== undefined) this.look.setHeat(view.heat, view.isDensity ?? false);
    if (view.filter) this.contacts.set(view.filter);
    if (view.selected) this.selectBodies(view.selected, contactOf(view));
    const tab = TABS.find((name) => name === view.tab);
    if (tab) this.showTab(tab);
    if (view.isFollowing && this.card.id >= 0) this.follow(this.card.id);
    if (view.camera) this.stage.setCamera(view.camera);
    if (view.frame === undefined || view.frame === null || !playback) return;
    playback.playing = false;
    this.wantedFrame = view.frame;
    this.seekWanted();
  }

  /** A log may not have been read so far yet. */
  private seekWanted(): void {
    const {source, wantedFrame} = this;
    if (!source?.playback || wantedFrame < 0) return;
    source.playback.seek(wantedFrame);
    if (source.isComplete || wantedFrame <= source.playback.last) this.wantedFrame = -1;
  }

  /** Keeps the address up to date while the picture rests; browsers limit how often it may change. */
  private updateLink(now: number): void {
    if (now < this.linkAt || this.link) return;
    this.linkAt = now + LINK_MS;
    const playback = this.source?.playback;
    if (playback?.playing) return;
    const text = `#${this.linkText()}`;
    if (text !== location.hash) history.replaceState(null, '', text);
  }

  private async copyLink(): Promise<void> {
    const link = `${location.href.split('#')[0]}#${this.linkText()}`;
    history.replaceState(null, '', link);
    await this.copyText(link, el('linkButton'));
  }

  /** Returns the command that draws this view without a browser. */
  renderCommand(): string {
    return renderCommand(this.run?.scene ?? '', this.view(), freeRect(), innerHeight, this.stage.camera.fov);
  }

  /** Copies text; the button says so. A page without that right shows the text. */
  private async copyText(text: string, button: HTMLElement): Promise<void> {
    const name = button.dataset.name ?? (button.dataset.name = button.textContent ?? '');
    try {
      await navigator.clipboard.writeText(text);
      setText(button, 'Copied');
      setTimeout(() => setText(button, name), 2000);
    } catch {
      this.notice('Copy this text', text);
    }
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
    setText(el('clockNow'), clock(playback.time_s));
    setText(el('clockEnd'), ` / ${clock(playback.last * playback.step_s)}`);
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
    const mark = this.stage.marks.at(x, y);
    const isEmpty = !this.look.layers.some((layer) => layer !== 'shadows' && layer !== 'tint');
    if (mark < 0 && isEmpty) return; // no body is drawn
    if (mark < 0) return this.choose(pick(this.run, this.frame, caster.ray, slack_m));
    const pair = pairAt(this.frame, mark);
    this.contacts.clear();
    this.selectBodies([pair.a, pair.b], pair);
  }

  private choose(id: number): void {
    this.contacts.clear();
    this.selectBodies(id < 0 ? [] : [id]);
    if (id < 0) this.follow(-1);
    else if (this.stage.followed >= 0) this.follow(id);
  }

  /** Selects up to two bodies, and one contact of them; the card shows the first body. */
  private selectBodies(bodies: number[], contact: Bodies | null = null): void {
    this.contact = this.stage.marks.contact = contact;
    this.historyAt = 0;
    this.historyOf = '';
    this.isPanelOld = true;
    const {run} = this;
    this.selected = run ? bodies.filter((body) => body < run.avatars + run.obstacles.length) : [];
    this.stage.select(...this.selected);
    const person = this.selected.find((body) => run && body < run.avatars);
    this.source?.loadProximity(person ?? -1);
    this.showDistances();
    if (person === undefined || !run) return this.card.close();
    if (isNarrow() && this.selected.length === 1) this.togglePanel(false);
    this.card.open(run, person);
    this.updateCard();
  }

  private toggleFollow(): void {
    this.follow(this.stage.followed < 0 ? this.card.id : -1);
  }

  private follow(id: number): void {
    this.stage.followed = id;
    el('follow').setAttribute('aria-pressed', String(id >= 0));
    if (id < 0 || !this.run || !this.frame) return;
    this.stage.approach(personOf(this.frame, id).position_m, heightOf(this.run, id));
    this.stage.recentre();
  }

  // Theme, panel and keys

  private get theme(): ThemeName {
    return document.documentElement.dataset.theme === 'dark' ? 'dark' : 'light';
  }

  private setTheme(name: ThemeName): void {
    document.documentElement.dataset.theme = name;
    this.style = null;
    this.stage.setTheme(name);
  }

  private chooseTheme(name: ThemeName): void {
    this.chosenTheme = name;
    this.setTheme(name);
  }

  /** Changes the address at once, because updateLink() waits until the picture rests. */
  private toggleTheme(): void {
    this.chooseTheme(this.theme === 'dark' ? 'light' : 'dark');
    history.replaceState(null, '', `#${withTheme(location.hash, this.theme)}`);
  }

  private togglePanel(open = el('panel').classList.contains('closed')): void {
    el('panel').classList.toggle('closed', !open);
    el('panelButton').setAttribute('aria-expanded', String(open));
    // On a phone the panel covers the card.
    el('card').classList.toggle('covered', open && isNarrow());
    this.stage.recentre();
  }

  private stepContact(direction: number): void {
    this.togglePanel(true);
    this.showTab('contacts');
    this.contacts.step(direction);
  }

  private moveView([right, up]: [number, number], isMoved: boolean): void {
    this.follow(-1);
    if (isMoved) this.stage.move(MOVE * right, MOVE * up);
    else this.stage.turn(TURN_RAD * right, TURN_RAD * up);
  }

  private resize(): void {
    this.stage.resize(innerWidth, innerHeight);
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || el<HTMLDialogElement>('help').open) return;
    if (this.video.isFilming) return; // the film would change
    // Fields and lists use these keys themselves.
    const target = event.target instanceof HTMLElement ? event.target : null;
    if (target?.matches('select, input:not([type=range]):not([type=checkbox])')) {
      if (event.key === 'Escape') target.blur();
      return;
    }
    // A button that was clicked keeps the focus, but Space plays.
    const onButton = !this.isFocusFromPointer && target?.matches('button');
    if (onButton && (event.key === ' ' || event.key === 'Enter')) return;
    const playback = this.source?.playback;
    const far = event.shiftKey && playback ? Math.round(1 / playback.step_s) : 1;
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
      v: () => {
        this.follow(-1);
        this.stage.topView();
      },
      '+': () => this.stage.zoom(ZOOM),
      '-': () => this.stage.zoom(1 / ZOOM),
      n: () => this.stepContact(1),
      p: () => this.stepContact(-1),
      '/': () => this.finder.focus(),
      k: () => void this.copyLink(),
      l: () => this.togglePanel(),
      t: () => this.toggleTheme(),
      '?': () => el<HTMLDialogElement>('help').showModal(),
      h: () => el<HTMLDialogElement>('help').showModal(),
      escape: () => this.choose(-1),
    };
    const key = event.key.toLowerCase();
    if (key in WAYS) actions[key] = () => this.moveView(WAYS[key], event.shiftKey);
    const action = actions[key] ?? (/^[1-9]$/.test(key) ? () => this.look.toggle(key) : null);
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
    const p = this.stage.project(...pointOf(this.run, this.frame, id, CHEST).toArray());
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

/** Returns the contact that a link selects, if it names its parts. */
function contactOf({selected, parts}: Partial<PageView>): Bodies | null {
  if (selected?.length !== 2 || parts?.length !== 2) return null;
  return {a: selected[0], b: selected[1], partA: parts[0], partB: parts[1]};
}

/** Offers a file as a download. */
function saveFile(name: string, file: Blob): void {
  const link = make('a', {download: name, href: URL.createObjectURL(file)}) as HTMLAnchorElement;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** Returns the part of the window that no panel covers, in CSS pixels. */
function freeRect(): {left: number; top: number; right: number; bottom: number} {
  const GAP = 10;
  const header = document.querySelector('.bar')!.getBoundingClientRect();
  const panel = el('panel');
  const card = el('card');
  const footer = [el('timeline'), el('pauseBar')].find((bar) => !bar.hidden)?.getBoundingClientRect();
  const isOpen = !panel.classList.contains('closed');
  const bottom = footer ? footer.top : innerHeight;
  return {
    left: (card.hidden || isNarrow() ? 0 : card.getBoundingClientRect().right) + GAP,
    top: header.bottom + GAP,
    right: (isOpen && !isNarrow() ? innerWidth - panel.offsetWidth - GAP : innerWidth) - GAP,
    bottom: (isOpen && isNarrow() ? bottom - panel.offsetHeight - GAP : bottom) - GAP,
  };
}

const page = new Page();
Object.assign(window, {throng: page});
page.open().catch((error: Error) => {
  const box = el('notice');
  box.hidden = false;
  box.replaceChildren('This recording cannot be shown', make('small', {}, error.message));
});
