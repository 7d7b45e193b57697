// Stage draws a run: camera, ground, obstacles, light and crowd.
// Invariant: it redraws only if something has changed.
import {Color, PerspectiveCamera, Scene, Vector2, Vector3, Vector4, WebGLRenderer} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import {Crowd, type Layer} from './crowd.ts';
import {around, fit, pointOf, scenePoints, type Rect, type View} from './framing.ts';
import {Ground} from './ground.ts';
import {Marks} from './marks.ts';
import {HeatMap, type HeatCells} from './heat.ts';
import {personOf, type Frame, type ProximityRow, type Run} from './protocol.ts';
import {THEMES, type ThemeName} from './theme.ts';
import {Walls} from './walls.ts';

const UP = new Vector3(0, 0, 1);
const NORTH = new Vector3(0, 1, 0);
const DOWN = new Vector3(0, 0, -1);
/** Views of the whole scene: from south-west and above; the other one where that makes it larger. */
const OVERVIEWS = [new Vector3(0.36, 0.78, -0.52).normalize(), new Vector3(0.78, 0.36, -0.52).normalize()];
const MUCH_NEARER = 0.8;
/** Shares of the free rectangle that the whole scene and single bodies fill. */
const SCENE_SHARE = 0.95;
const BODIES_SHARE = 0.6;
/** Half the width shown at least around bodies, in metres. */
const AROUND_BODIES_M = 1.6;
const STEEP_RAD = (15 * Math.PI) / 180;
const PITCH_RAD = (30 * Math.PI) / 180;
/** In units of the distance that shows the whole scene. */
const MAX_DISTANCE = 4;
/** The eye stays above the ground. */
const MIN_EYE_M = 0.15;
const FAR_M = 4000;
const SUN = new Vector3(-0.45, -0.55, 1).normalize();
const FOV_DEG = 40;
/** Height of a film in units of its marks: they look as large as in a window of this height. */
const FILM_LINES = 720;
const SLOW_MS = 30;
const FAST_MS = 18;
const MIN_TRIANGLES = 100_000;
const MAX_TRIANGLES = 6_000_000;
/** Heights at which walls must not hide selected people, as shares of the height. */
const SIGHTS = [0.05, 0.5, 0.95];
const MIN_PIXELS = 0.75;
/** After this rest the picture is drawn again at a quality that takes about a second. */
const REST_MS = 300;
const TRIANGLES_AT_REST = 500_000;
/** Names of drivers that render on the processor. */
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i;

/** Returns whether there is no graphics card. A separate context reports it before the real one is created. */
function isSoftware(): boolean {
  const gl = document.createElement('canvas').getContext('webgl2');
  const names = gl?.getExtension('WEBGL_debug_renderer_info');
  const isSoftwareDriver = !!gl && !!names && SOFTWARE.test(String(gl.getParameter(names.UNMASKED_RENDERER_WEBGL)));
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return isSoftwareDriver;
}

/** The rows of WebGL begin at the bottom. */
function flipRows({data, width, height}: ImageData): void {
  const bytes = 4 * width;
  const row = new Uint8ClampedArray(bytes);
  for (let top = 0, bottom = (height - 1) * bytes; top < bottom; top += bytes, bottom -= bytes) {
    row.set(data.subarray(top, top + bytes));
    data.copyWithin(top, bottom, bottom + bytes);
    data.set(row, bottom);
  }
}

export class Stage {
  readonly camera = new PerspectiveCamera(FOV_DEG, 1, 0.1, 4000);
  readonly controls: OrbitControls;
  readonly renderer: WebGLRenderer;
  readonly marks: Marks;
  /** The avatar that the camera follows; -1: none. */
  followed = -1;
  /** The part of the window, in pixels, that no panel covers; call recentre() when it changes. */
  freeRect: () => Rect = () => ({left: 0, top: 0, right: this.size[0], bottom: this.size[1]});
  private readonly scene = new Scene();
  private readonly heat = new HeatMap();
  private readonly ground: Ground;
  private crowd: Crowd | null = null;
  private walls: Walls | null = null;
  private selected: readonly number[] = [];
  private readonly sights = Array.from({length: 2 * SIGHTS.length}, () => new Vector3());
  /** What the camera was fitted to and still shows, so that another window size fits it again. */
  private framed: '' | 'scene' | 'top' = '';
  private viewBefore: View | null = null; // of the top view
  private frame: Frame | null = null;
  private run: Run | null = null;
  private size: [number, number] = [1, 1];
  private pixels = 1;
  private mean_ms = 16;
  private isChanged = true;
  private wasRendered = false;
  private isFilming = false;
  private rested_ms = 0;
  private readonly isSlow = isSoftware();
  private readonly shared = {
    uSun: {value: SUN},
    uSky: {value: new Color()},
    uEarth: {value: new Color()},
    uSunColor: {value: new Color()},
    uFog: {value: new Color()},
    uFogRange: {value: new Vector2(100, 300)},
    uEye: {value: new Vector3()},
    uShadow: {value: new Vector4()},
    uFaded: {value: new Color()},
    uSeesThrough: {value: 0},
    uChosen: {value: new Color()},
  };
  private readonly wallColors = {solid: {value: new Color()}, chosen: {value: new Color()}};

  constructor(canvas: HTMLCanvasElement) {
    const antialias = !this.isSlow;
    this.renderer = new WebGLRenderer({canvas, antialias, stencil: true, powerPreference: 'high-performance'});
    // A check would wait for the compiler; the browser reports a defective shader by itself.
    this.renderer.debug.checkShaderErrors = false;
    document.documentElement.classList.toggle('slow', this.isSlow);
    canvas.addEventListener('webglcontextrestored', () => {
      this.crowd?.restore();
      this.ground.restore();
      this.isChanged = true;
    });
    this.marks = new Marks(canvas);
    this.camera.up.copy(UP);
    this.camera.position.set(-10, -16, 9);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.maxPolarAngle = Math.PI * 0.495;
    this.controls.minDistance = 0.8;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('start', () => (this.framed = ''));
    // The wheel moves the camera before the next picture asks whether it has moved.
    this.controls.addEventListener('change', () => (this.isChanged = true));
    this.ground = new Ground(this.shared, this.isSlow);
    this.scene.add(this.ground.group, this.heat.mesh);
  }

  setTheme(name: ThemeName): void {
    const theme = THEMES[name];
    this.shared.uSky.value.copy(theme.sky);
    this.shared.uEarth.value.copy(theme.earth);
    this.shared.uSunColor.value.copy(theme.sun);
    this.shared.uFog.value.set(theme.fog);
    this.shared.uShadow.value.fromArray(theme.shadow);
    this.shared.uFaded.value.set(theme.faded);
    this.shared.uChosen.value.set(theme.chosen);
    this.wallColors.solid.value.set(theme.solid);
    // A wall is large: a hint of the colour suffices.
    this.wallColors.chosen.value.set(theme.solid).lerp(this.shared.uChosen.value, 0.35);
    this.renderer.setClearColor(new Color(theme.fog));
    this.ground.setTheme(theme);
    this.crowd?.setCalm(theme.calm);
    this.isChanged = true;
  }

  setRun(run: Run): void {
    this.clear();
    this.run = run;
    this.crowd = new Crowd(run, this.shared);
    if (this.isSlow) this.crowd.budget = MIN_TRIANGLES;
    this.walls = new Walls(run, this.shared, this.wallColors);
    this.scene.add(this.crowd.group, this.walls.group);
    this.setGround(run);
    this.select(...this.selected);
    this.overview();
    // Submits all shaders before waiting for the first one.
    this.renderer.compile(this.scene, this.camera);
    this.isChanged = true;
  }

  private clear(): void {
    for (const drawn of [this.crowd, this.walls]) {
      drawn?.group.removeFromParent();
      drawn?.dispose();
    }
    this.frame = null;
  }

  private setGround(run: Run): void {
    const {min_m, max_m} = run.ground;
    const size_m = Math.max(max_m[0] - min_m[0], max_m[1] - min_m[1], 10);
    this.ground.setRun(run, size_m);
    this.shared.uFogRange.value.set(1.2 * size_m + 40, 4 * size_m + 160);
  }

  /** Shows the whole scene from above at a slant, as large as the free rectangle allows. */
  overview(): void {
    if (!this.run) return;
    const points = scenePoints(this.run, this.frame);
    const [first, second] = OVERVIEWS.map((direction) => this.fitted(points, direction, UP));
    const distance = (view: View): number => view.position.distanceTo(view.target);
    const whole = distance(second) < MUCH_NEARER * distance(first) ? second : first;
    this.controls.maxDistance = MAX_DISTANCE * distance(whole);
    this.place(whole);
    this.followed = -1;
    this.framed = 'scene';
    this.viewBefore = null;
  }

  /** Shows the scene from straight above, north up, or the view before; returns whether from above. */
  topView(on = this.viewBefore === null): boolean {
    if (!this.run || on === (this.viewBefore !== null)) return on;
    const before = this.viewBefore;
    this.followed = -1;
    if (before) {
      this.place(before);
      this.viewBefore = null;
      this.framed = '';
    } else {
      this.viewBefore = {position: this.camera.position.clone(), target: this.controls.target.clone()};
      this.fitFromTop(this.run);
    }
    return on;
  }

  private fitFromTop(run: Run): void {
    this.place(this.fitted(scenePoints(run, this.frame), DOWN, NORTH));
    this.framed = 'top';
  }

  /** Shows points, such as the chests and feet of two people, from near and in the direction of the present view. */
  showBodies(points: Vector3[]): void {
    if (points.length === 0) return;
    const direction = this.slanted();
    const across = new Vector3().crossVectors(direction, UP).setLength(AROUND_BODIES_M);
    const centre = points.reduce((sum, point) => sum.add(point), new Vector3()).divideScalar(points.length);
    const all = [...points, centre.clone().add(across), centre.clone().sub(across)];
    this.place(this.fitted(all, direction, UP, BODIES_SHARE));
    this.framed = '';
    this.viewBefore = null;
  }

  /** Returns the direction of the view; a less steep one if it is almost vertical. */
  private slanted(): Vector3 {
    const direction = new Vector3().subVectors(this.controls.target, this.camera.position).normalize();
    if (direction.angleTo(DOWN) > STEEP_RAD) return direction;
    const north = NORTH.clone().applyQuaternion(this.camera.quaternion).setZ(0).normalize();
    return north.multiplyScalar(Math.cos(PITCH_RAD)).setZ(-Math.sin(PITCH_RAD));
  }

  private fitted(points: Vector3[], direction: Vector3, up: Vector3, share = SCENE_SHARE): View {
    const [width, height] = this.size;
    return fit(points, direction, up, this.camera.fov, width / height, around(this.freeRect(), width, height, share));
  }

  private place({position, target}: View): void {
    const distance = position.distanceTo(target);
    this.camera.position.copy(position);
    this.controls.target.copy(target);
    this.controls.maxDistance = Math.max(this.controls.maxDistance, 2 * distance);
    this.camera.far = Math.max(FAR_M, 4 * distance);
    this.controls.update();
    this.camera.updateMatrixWorld();
    // A narrow window puts the camera far away, where fog must not hide the scene.
    const fog = this.shared.uFogRange.value;
    fog.set(Math.max(fog.x, 1.5 * distance), Math.max(fog.y, 4 * distance));
    this.centre();
  }

  /** Adapts the view to another window or free rectangle: a view of the whole scene shows all of it again. */
  recentre(): void {
    this.centre();
    if (this.framed === 'scene') this.overview();
    if (this.framed === 'top' && this.run) this.fitFromTop(this.run);
  }

  /** Moves the optical centre to the middle of the free rectangle. */
  private centre(): void {
    if (this.isFilming) return;
    const [width, height] = this.size;
    const free = this.freeRect();
    const left = (width - free.left - free.right) / 2;
    const top = (height - free.top - free.bottom) / 2;
    this.camera.setViewOffset(width, height, left, top, width, height);
    this.isChanged = true;
  }

  /** Moves the camera close to a person and keeps its direction. */
  approach(position: [number, number, number], height_m: number): void {
    const away = new Vector3().subVectors(this.camera.position, this.controls.target);
    this.controls.target.set(position[0], position[1], position[2] + 0.55 * height_m);
    away.setLength(Math.min(away.length(), 5.5));
    this.camera.position.copy(this.controls.target).add(away);
    this.framed = '';
    this.viewBefore = null;
  }

  /** Turns the view around its target, in radians to the right and up. */
  turn(right: number, up: number): void {
    const away = new Vector3().subVectors(this.camera.position, this.controls.target);
    const across = new Vector3(1, 0, 0).applyQuaternion(this.camera.quaternion);
    const polar = away.angleTo(UP);
    const {minPolarAngle, maxPolarAngle} = this.controls;
    const tilt = Math.min(maxPolarAngle, Math.max(minPolarAngle + 1e-3, polar - up)) - polar;
    away.applyAxisAngle(across, tilt).applyAxisAngle(UP, -right);
    this.camera.position.copy(this.controls.target).add(away);
    this.framed = '';
  }

  /** Moves the view over the ground, to the right and ahead, in shares of the distance from its target. */
  move(right: number, ahead: number): void {
    const {position, quaternion} = this.camera;
    const across = new Vector3(1, 0, 0).applyQuaternion(quaternion);
    const step = across.clone().multiplyScalar(right).addScaledVector(new Vector3().crossVectors(UP, across), ahead);
    step.multiplyScalar(position.distanceTo(this.controls.target));
    position.add(step);
    this.controls.target.add(step);
    this.framed = '';
  }

  /** Moves the eye to this multiple of its distance from the target. */
  zoom(factor: number): void {
    const {target, minDistance, maxDistance} = this.controls;
    const away = new Vector3().subVectors(this.camera.position, target);
    away.setLength(Math.min(maxDistance, Math.max(minDistance, factor * away.length())));
    this.camera.position.copy(target).add(away);
    this.framed = '';
  }

  /** Restores a camera: its position, then its target. */
  setCamera([x, y, z, ...target]: readonly number[]): void {
    this.place({position: new Vector3(x, y, z), target: new Vector3(...target)});
    this.framed = '';
    this.viewBefore = null;
  }

  show(layer: Layer, visible: boolean): void {
    this.crowd?.show(layer, visible);
    if (layer === 'shadows') this.walls?.showShadows(visible);
    this.isChanged = true;
  }

  /** Highlights bodies: up to two people, and obstacles from run.avatars on. Negative ids are none. */
  select(...ids: number[]): void {
    this.selected = ids.filter((id) => id >= 0);
    this.shared.uSeesThrough.value = this.selected.length > 0 ? 1 : 0;
    const [first = -1, second = -1] = this.selectedPeople();
    this.crowd?.select(first, second);
    this.isChanged = true;
  }

  private selectedPeople(): number[] {
    const avatars = this.run?.avatars ?? 0;
    return this.selected.filter((id) => id < avatars).slice(0, 2);
  }

  /** Fades people whose flag is 0, one flag per avatar; null ends fading, as does a new run. */
  setFocus(flags: Uint8Array | null): void {
    this.crowd?.setFocus(flags);
    this.isChanged = true;
  }

  /** Replaces clothes by sRGB colours, four bytes per avatar, where the fourth is 255; null restores clothes. */
  setColors(rgba: Uint8Array | null): void {
    this.crowd?.setColors(rgba);
    this.isChanged = true;
  }

  /** Shows a floor map; null hides it. */
  setHeat(cells: HeatCells | null, isDark: boolean): void {
    this.heat.set(cells, isDark);
    this.isChanged = true;
  }

  /** Draws lines between a body and the nearest others. */
  setDistances(body: number, rows: ProximityRow[]): void {
    const {distances} = this.marks;
    if (distances.rows.length === 0 && rows.length === 0) return;
    distances.body = body;
    distances.rows = rows;
    this.isChanged = true;
  }

  take(frame: Frame): void {
    const isFirst = this.frame === null;
    this.frame = frame;
    this.crowd?.take(frame);
    this.isChanged = true;
    // People may stand outside of the ground that the run describes.
    if (isFirst && this.framed === 'scene') this.overview();
    if (this.followed < 0 || this.followed >= frame.avatars) return;
    const person = personOf(frame, this.followed);
    if (!person.present) return;
    const step = new Vector3(person.position_m[0], person.position_m[1], this.controls.target.z).sub(
      this.controls.target,
    );
    // Moves with the person, and towards the middle until the person is centred.
    this.controls.target.add(step);
    this.camera.position.add(step);
  }

  resize(width: number, height: number): void {
    if (this.isFilming) return;
    this.size = [Math.max(1, width), Math.max(1, height)];
    this.pixels = this.sharpest;
    this.renderer.setDrawingBufferSize(width, height, this.pixels);
    this.marks.resize(...this.size);
    this.recentre();
  }

  private get sharpest(): number {
    return Math.min(window.devicePixelRatio || 1, 2);
  }

  private setPixels(ratio: number): void {
    if (this.renderer.getPixelRatio() !== ratio) this.renderer.setDrawingBufferSize(this.size[0], this.size[1], ratio);
  }

  /** Draws if the picture would differ from the last one; returns whether it did. */
  render(frame: Frame | null, dt_ms: number): boolean {
    this.adapt(dt_ms);
    this.controls.update();
    const lift_m = Math.max(0, MIN_EYE_M - this.camera.position.z);
    this.camera.position.z += lift_m;
    this.controls.target.z += lift_m;
    this.wasRendered = this.isChanged;
    this.isChanged = false;
    if (this.wasRendered) {
      this.rested_ms = 0;
      this.setPixels(this.pixels);
      this.draw(frame, this.crowd?.budget ?? 0);
    } else if (this.rested_ms < REST_MS) {
      this.rested_ms += dt_ms;
      if (this.rested_ms >= REST_MS) this.drawAtRest(frame);
    }
    return this.wasRendered;
  }

  private draw(frame: Frame | null, triangles: number): void {
    this.camera.updateMatrixWorld();
    this.shared.uEye.value.copy(this.camera.position);
    if (frame) {
      this.crowd?.arrange(frame, this.camera, triangles, this.renderer.domElement.height);
      this.crowd?.pose(this.renderer);
      this.arrangeWalls(frame);
    }
    this.ground.prepare(this.renderer, this.camera);
    this.renderer.render(this.scene, this.camera);
    if (this.run) this.marks.draw(this.run, frame, this.camera, this.selected);
  }

  /** Returns the present picture with its marks as a PNG, `scale` times as large as the window. */
  async picture(scale: number): Promise<Blob> {
    const [width, height] = this.size;
    this.renderer.setDrawingBufferSize(width, height, scale);
    const canvas = document.createElement('canvas');
    canvas.width = width * scale;
    canvas.height = height * scale;
    this.drawInto(canvas, MAX_TRIANGLES);
    this.isChanged = true;
    const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done, 'image/png'));
    if (!blob) throw new Error('the browser cannot make a picture of this size');
    return blob;
  }

  private drawInto(picture: HTMLCanvasElement, triangles: number): void {
    this.draw(this.frame, triangles);
    this.read(picture);
  }

  /** Waits for the drawing and copies it: much faster than drawing the stage's canvas into another one. */
  read(picture: HTMLCanvasElement): void {
    const {width, height} = picture;
    const context = picture.getContext('2d', {willReadFrequently: true})!;
    const image = context.createImageData(width, height);
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(image.data.buffer));
    flipRows(image);
    context.putImageData(image, 0, 0);
    this.marks.paint(context, width);
  }

  /** Begins to draw a picture of this size, which holds what the free rectangle of the window shows. */
  film(width: number, height: number): void {
    if (!this.isFilming) {
      this.isFilming = true;
      this.camera.fov = this.fovOf(width / height);
      this.camera.setViewOffset(width, height, 0, 0, width, height);
      this.renderer.setDrawingBufferSize(width, height, 1);
      const scale = height / FILM_LINES;
      this.marks.resize(width / scale, height / scale, scale);
    }
    this.draw(this.frame, this.isSlow ? MIN_TRIANGLES : TRIANGLES_AT_REST);
    this.renderer.getContext().flush();
  }

  /** Returns the angle of view at which a picture of this shape holds the free rectangle. */
  private fovOf(aspect: number): number {
    const free = this.freeRect();
    const height = Math.max(free.bottom - free.top, (free.right - free.left) / aspect);
    const half = Math.tan((this.camera.fov * Math.PI) / 360) * (height / this.size[1]);
    return (360 / Math.PI) * Math.atan(half);
  }

  /** Shows the view in the window again. */
  endFilm(): void {
    if (!this.isFilming) return;
    this.isFilming = false;
    this.camera.fov = FOV_DEG;
    this.resize(innerWidth, innerHeight);
  }

  private arrangeWalls(frame: Frame): void {
    const people = this.selectedPeople().filter((id) => personOf(frame, id).present);
    const sights = people.flatMap((id, i) =>
      SIGHTS.map((share, k) => pointOf(this.run!, frame, id, share, this.sights[i * SIGHTS.length + k])),
    );
    this.walls?.arrange(this.camera.position, sights, this.selected);
  }

  private drawAtRest(frame: Frame | null): void {
    if (!this.crowd || (this.crowd.budget >= TRIANGLES_AT_REST && this.pixels === this.sharpest)) return;
    this.setPixels(this.sharpest);
    this.draw(frame, Math.max(this.crowd.budget, TRIANGLES_AT_REST));
  }

  /** Reduces triangles and pixels on a slow machine, increases them on a fast one. */
  private adapt(dt_ms: number): void {
    // Without a drawn picture the time since the last one means nothing.
    if (!this.crowd || document.hidden || !this.wasRendered) return;
    this.mean_ms += 0.15 * (Math.min(dt_ms, 300) - this.mean_ms);
    if (this.mean_ms > SLOW_MS) {
      this.crowd.budget = Math.max(MIN_TRIANGLES, this.crowd.budget * 0.9);
      if (this.crowd.budget === MIN_TRIANGLES && this.pixels > MIN_PIXELS)
        this.pixels = Math.max(MIN_PIXELS, 0.7 * this.pixels);
    } else if (this.mean_ms < FAST_MS) {
      this.crowd.budget = Math.min(MAX_TRIANGLES, this.crowd.budget * 1.03);
    }
  }

  /** Returns the place on the ground under a pixel; null above the horizon. */
  groundAt(x: number, y: number): Vector3 | null {
    const [width, height] = this.size;
    const {position} = this.camera;
    const ray = new Vector3((2 * x) / width - 1, 1 - (2 * y) / height, 0.5).unproject(this.camera).sub(position);
    return ray.z < 0 ? ray.multiplyScalar(-position.z / ray.z).add(position) : null;
  }

  /** Returns the normalised device coordinates of a point. */
  project(x: number, y: number, z: number): [number, number] {
    const p = new Vector3(x, y, z).project(this.camera);
    return [p.x, p.y];
  }

  get drawn(): {calls: number; triangles: number; budget: number} {
    const {calls, triangles} = this.renderer.info.render;
    return {calls, triangles, budget: this.crowd?.budget ?? 0};
  }
}
