// Stage draws a run: camera, ground, obstacles, light and crowd.
// Invariant: it redraws only if something has changed.
import {
  Color,
  DoubleSide,
  GLSL3,
  Group,
  Mesh,
  Path,
  PerspectiveCamera,
  PlaneGeometry,
  RawShaderMaterial,
  Scene,
  Shape,
  ShapeGeometry,
  Vector2,
  Vector3,
  Vector4,
  WebGLRenderer,
} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import {solidGeometry} from './bodies.ts';
import {Crowd, oncePerPixel, type Layer} from './crowd.ts';
import {personOf, type Frame, type Run} from './protocol.ts';
import {
  FLAT_SHADOW_VERTEX,
  GROUND_FRAGMENT,
  SHADOW_FRAGMENT,
  SOLID_FRAGMENT,
  SOLID_VERTEX,
} from './shaders.ts';
import {THEMES, type ThemeName} from './theme.ts';

const SUN = new Vector3(-0.45, -0.55, 1).normalize();
const SLOW_MS = 30;
const FAST_MS = 18;
const MIN_TRIANGLES = 100_000;
const MAX_TRIANGLES = 6_000_000;
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

export class Stage {
  readonly camera = new PerspectiveCamera(40, 1, 0.1, 4000);
  readonly controls: OrbitControls;
  readonly renderer: WebGLRenderer;
  /** The avatar that the camera follows; -1: none. */
  followed = -1;
  private readonly scene = new Scene();
  private readonly solids = new Group();
  private readonly ground: Mesh;
  private crowd: Crowd | null = null;
  private run: Run | null = null;
  private size: [number, number] = [1, 1];
  private pixels = 1;
  private mean_ms = 16;
  private isChanged = true;
  private wasRendered = false;
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
  };
  private readonly groundColors = {
    uGround: {value: new Color()},
    uBeyond: {value: new Color()},
    uLine: {value: new Color()},
    uBounds: {value: new Vector4()},
  };
  /** All of the floor is inside the bounds. */
  private readonly floorColors = {...this.groundColors, uBounds: {value: new Vector4(-3e5, -3e5, 3e5, 3e5)}};
  private readonly solidColor = {uColor: {value: new Color()}};

  constructor(canvas: HTMLCanvasElement) {
    const antialias = !this.isSlow;
    this.renderer = new WebGLRenderer({canvas, antialias, stencil: true, powerPreference: 'high-performance'});
    // A check would wait for the compiler; the browser reports a defective shader by itself.
    this.renderer.debug.checkShaderErrors = false;
    document.documentElement.classList.toggle('slow', this.isSlow);
    canvas.addEventListener('webglcontextrestored', () => (this.isChanged = true));
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(-10, -16, 9);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.maxPolarAngle = Math.PI * 0.495;
    this.controls.minDistance = 0.8;
    this.controls.maxDistance = 1500;
    this.controls.zoomToCursor = true;
    const ground = this.material(SOLID_VERTEX, GROUND_FRAGMENT, this.groundColors);
    // Drawn first and behind everything: shadows lie in its plane, where depth values are equal.
    ground.depthWrite = false;
    this.ground = new Mesh(new PlaneGeometry(1, 1), ground);
    this.ground.renderOrder = -1;
    this.scene.add(this.ground, this.solids);
  }

  private material(vertexShader: string, fragmentShader: string, own: object): RawShaderMaterial {
    const uniforms = {...this.shared, ...own};
    return new RawShaderMaterial({glslVersion: GLSL3, vertexShader, fragmentShader, uniforms});
  }

  setTheme(name: ThemeName): void {
    const theme = THEMES[name];
    this.shared.uSky.value.copy(theme.sky);
    this.shared.uEarth.value.copy(theme.earth);
    this.shared.uSunColor.value.copy(theme.sun);
    this.shared.uFog.value.set(theme.fog);
    this.shared.uShadow.value.fromArray(theme.shadow);
    this.groundColors.uGround.value.set(theme.ground);
    this.groundColors.uBeyond.value.set(theme.beyond);
    this.groundColors.uLine.value.set(theme.line);
    this.solidColor.uColor.value.set(theme.solid);
    this.renderer.setClearColor(new Color(theme.fog));
    this.crowd?.setCalm(theme.calm);
    this.isChanged = true;
  }

  setRun(run: Run): void {
    this.crowd?.group.removeFromParent();
    this.crowd?.dispose();
    this.run = run;
    this.crowd = new Crowd(run, this.shared);
    if (this.isSlow) this.crowd.budget = MIN_TRIANGLES;
    this.scene.add(this.crowd.group);
    const {min_m, max_m} = run.ground;
    const size = Math.max(max_m[0] - min_m[0], max_m[1] - min_m[1], 10);
    if (run.ground.floor.length > 0) this.groundColors.uBounds.value.set(3e5, 3e5, -3e5, -3e5);
    else this.groundColors.uBounds.value.set(min_m[0], min_m[1], max_m[0], max_m[1]);
    this.ground.scale.setScalar(20 * size + 800);
    this.ground.position.set((min_m[0] + max_m[0]) / 2, (min_m[1] + max_m[1]) / 2, 0);
    this.shared.uFogRange.value.set(1.2 * size + 40, 4 * size + 160);
    this.addSolids(run);
    this.addFloor(run);
    this.overview();
    // Submits all shaders before waiting for the first one.
    this.renderer.compile(this.scene, this.camera);
    this.isChanged = true;
  }

  private addSolids(run: Run): void {
    this.solids.clear();
    const solid = this.material(SOLID_VERTEX, SOLID_FRAGMENT, this.solidColor);
    const shadow = oncePerPixel(this.material(FLAT_SHADOW_VERTEX, SHADOW_FRAGMENT, {}));
    shadow.transparent = true;
    shadow.depthWrite = false;
    shadow.side = DoubleSide;
    for (const obstacle of run.obstacles) {
      const geometry = solidGeometry(obstacle.mesh);
      for (const material of [solid, shadow]) {
        const mesh = new Mesh(geometry, material);
        mesh.position.set(...obstacle.centre_m);
        mesh.rotation.z = obstacle.heading_rad;
        mesh.renderOrder = material === shadow ? 1 : 0;
        this.solids.add(mesh);
      }
    }
  }

  private addFloor(run: Run): void {
    if (run.ground.floor.length === 0) return;
    const points = (ring: [number, number][]) => ring.map(([x, y]) => new Vector2(x, y));
    const shapes = run.ground.floor.map(([outline, ...holes]) => {
      const shape = new Shape(points(outline!));
      shape.holes = holes.map((hole) => new Path(points(hole)));
      return shape;
    });
    const material = this.material(SOLID_VERTEX, GROUND_FRAGMENT, this.floorColors);
    material.depthWrite = false;
    const floor = new Mesh(new ShapeGeometry(shapes), material);
    floor.renderOrder = -0.5;
    this.solids.add(floor);
  }

  /** Moves the camera to see the whole ground, from south-west and above. */
  overview(): void {
    if (!this.run) return;
    const {min_m, max_m} = this.run.ground;
    const width = max_m[0] - min_m[0];
    const depth = max_m[1] - min_m[1];
    const radius = Math.max(3, 0.5 * Math.hypot(width, depth));
    const half = Math.tan((this.camera.fov * Math.PI) / 360) * Math.min(1.35, this.camera.aspect);
    const distance = (0.62 * radius) / half;
    this.controls.target.set((min_m[0] + max_m[0]) / 2, (min_m[1] + max_m[1]) / 2 - 0.06 * depth, 0.6);
    const back = new Vector3(-0.36, -0.78, 0.52).normalize();
    this.camera.position.copy(this.controls.target).addScaledVector(back, distance);
    this.followed = -1;
  }

  /** Moves the camera close to a person and keeps its direction. */
  approach(position: [number, number, number], height_m: number): void {
    const away = new Vector3().subVectors(this.camera.position, this.controls.target);
    this.controls.target.set(position[0], position[1], position[2] + 0.55 * height_m);
    away.setLength(Math.min(away.length(), 5.5));
    this.camera.position.copy(this.controls.target).add(away);
  }

  show(layer: Layer, visible: boolean): void {
    this.crowd?.show(layer, visible);
    this.isChanged = true;
  }

  select(id: number): void {
    this.crowd?.select(id);
    this.isChanged = true;
  }

  take(frame: Frame): void {
    this.crowd?.take(frame);
    this.isChanged = true;
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
    this.camera.aspect = width / Math.max(1, height);
    this.camera.updateProjectionMatrix();
    this.size = [width, height];
    this.pixels = this.sharpest;
    this.isChanged = true;
    this.renderer.setDrawingBufferSize(width, height, this.pixels);
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
    const isTurned = this.controls.update();
    this.wasRendered = isTurned || this.isChanged;
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
    if (frame) this.crowd?.arrange(frame, this.camera, triangles);
    this.renderer.render(this.scene, this.camera);
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
