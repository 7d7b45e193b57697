// Ground draws the scene's ground, what lies beyond it, and its floor.
// Invariant: a picture of a resting camera has the same pixels whether its ground is drawn or copied.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  FramebufferTexture,
  Group,
  Mesh,
  Path,
  PlaneGeometry,
  Shape,
  ShapeGeometry,
  Vector2,
  Vector4,
  type PerspectiveCamera,
  type RawShaderMaterial,
  type WebGLRenderer,
} from 'three';
import type {Run} from './protocol.ts';
import {COPY_FRAGMENT, COPY_VERTEX, GROUND_FRAGMENT, SOLID_VERTEX, shaderMaterial, type Uniforms} from './shaders.ts';
import type {Theme} from './theme.ts';

/** Bounds that all of the floor is inside, and that everything else is outside. */
const EVERYWHERE = new Vector4(-3e5, -3e5, 3e5, 3e5);
const NOWHERE = new Vector4(3e5, 3e5, -3e5, -3e5);
/** Order of drawing: before everything else. */
const FIRST = -1;
/** OrbitControls rounds a resting camera anew in each picture. */
const ROUNDING = 1e-9;

export class Ground {
  readonly group = new Group();
  private readonly surfaces = new Group();
  private readonly plane: Mesh;
  private floor: Mesh | null = null;
  private readonly colors = {uGround: {value: new Color()}, uBeyond: {value: new Color()}, uLine: {value: new Color()}};
  private readonly bounds = {value: new Vector4()};
  private readonly picture = {value: null as FramebufferTexture | null};
  private readonly copy: Mesh;
  private view: number[] = [];
  private copiedView: number[] = [];
  private changes = 0;

  /** `copies`: draws the ground of a resting camera once, which pays where the processor draws. */
  constructor(
    private readonly shared: Uniforms,
    private readonly copies: boolean,
  ) {
    this.plane = this.surface(new PlaneGeometry(1, 1), this.bounds, FIRST);
    const all = new BufferGeometry();
    all.setAttribute('position', new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    const material = shaderMaterial(COPY_VERTEX, COPY_FRAGMENT, {uPicture: this.picture});
    material.depthTest = material.depthWrite = false;
    this.copy = new Mesh(all, material);
    this.copy.frustumCulled = false;
    this.copy.renderOrder = FIRST;
    this.copy.visible = false;
    this.group.add(this.surfaces, this.copy);
  }

  private surface(shape: PlaneGeometry | ShapeGeometry, uBounds: {value: Vector4}, order: number): Mesh {
    const material = shaderMaterial(SOLID_VERTEX, GROUND_FRAGMENT, {...this.shared, ...this.colors, uBounds});
    // Drawn first and behind everything: shadows lie in its plane, where depth values are equal.
    material.depthWrite = false;
    const mesh = new Mesh(shape, material);
    mesh.renderOrder = order;
    this.surfaces.add(mesh);
    return mesh;
  }

  setTheme({ground, beyond, line}: Theme): void {
    this.colors.uGround.value.set(ground);
    this.colors.uBeyond.value.set(beyond);
    this.colors.uLine.value.set(line);
    ++this.changes;
  }

  setRun({ground: {min_m, max_m, floor}}: Run, size_m: number): void {
    this.bounds.value.copy(floor.length > 0 ? NOWHERE : new Vector4(min_m[0], min_m[1], max_m[0], max_m[1]));
    this.plane.scale.setScalar(20 * size_m + 800);
    this.plane.position.set((min_m[0] + max_m[0]) / 2, (min_m[1] + max_m[1]) / 2, 0);
    this.setFloor(floor);
    ++this.changes;
  }

  private setFloor(floor: Run['ground']['floor']): void {
    if (this.floor) {
      this.floor.removeFromParent();
      this.floor.geometry.dispose();
      (this.floor.material as RawShaderMaterial).dispose();
      this.floor = null;
    }
    if (floor.length === 0) return;
    const points = (ring: [number, number][]) => ring.map(([x, y]) => new Vector2(x, y));
    const shapes = floor.map(([outline, ...holes]) => {
      const shape = new Shape(points(outline!));
      shape.holes = holes.map((hole) => new Path(points(hole)));
      return shape;
    });
    this.floor = this.surface(new ShapeGeometry(shapes), {value: EVERYWHERE}, 0.5 * FIRST);
  }

  /** Decides whether the next picture draws the ground or copies it; call it before each. */
  prepare(renderer: WebGLRenderer, camera: PerspectiveCamera): void {
    if (!this.copies) return;
    const {width, height} = renderer.domElement;
    const {x: fogBegin_m, y: fogEnd_m} = this.shared.uFogRange!.value as Vector2;
    const matrices = [...camera.projectionMatrix.elements, ...camera.matrixWorldInverse.elements];
    const view = [...matrices, width, height, fogBegin_m, fogEnd_m, this.changes];
    const isResting = isSame(view, this.view);
    this.view = view;
    this.surfaces.visible = true;
    this.copy.visible = false;
    if (isResting && !isSame(view, this.copiedView)) {
      renderer.render(this.group, camera);
      this.picture.value?.dispose();
      this.picture.value = new FramebufferTexture(width, height);
      renderer.copyFramebufferToTexture(this.picture.value);
      this.copiedView = view;
    }
    this.surfaces.visible = !isResting;
    this.copy.visible = isResting;
  }

  /** Draws again what the graphics card has lost. */
  restore(): void {
    this.view = this.copiedView = [];
  }
}

function isSame(a: readonly number[], b: readonly number[]): boolean {
  return a.length === b.length && a.every((value, i) => Math.abs(value - b[i]!) <= ROUNDING * Math.max(1, Math.abs(value)));
}
