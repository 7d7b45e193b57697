// Crowd draws the people of a run: bodies by distance, shadows, spheres, or-DOPs and boxes.
// Invariant: a frame costs two texture copies; the distance alone decides the level of detail.
import {
  Camera,
  Color,
  DoubleSide,
  EqualStencilFunc,
  Frustum,
  Group,
  IncrementStencilOp,
  InstancedBufferGeometry,
  IcosahedronGeometry,
  LineSegments,
  Matrix4,
  Mesh,
  RawShaderMaterial,
  Sphere,
  Vector2,
  type DataTexture,
  type WebGLRenderer,
} from 'three';
import {Instances, bodyGeometries, boxGeometry, hullGeometry, shadowGeometry, sharing} from './bodies.ts';
import {Poser} from './poser.ts';
import {isPresent, type Frame, type Model, type Run} from './protocol.ts';
import {
  BODY_FRAGMENT,
  BODY_VERTEX,
  BOX_VERTEX,
  HULL_VERTEX,
  LINE_FRAGMENT,
  SHADOW_FRAGMENT,
  SHADOW_VERTEX,
  SPHERE_FRAGMENT,
  SPHERE_VERTEX,
  shaderMaterial,
  type Uniforms,
} from './shaders.ts';
import {dataOf, texelMap} from './texels.ts';
import {CLOTHES, MARK_COLORS} from './theme.ts';

export const LAYERS = ['meshes', 'spheres', 'hulls', 'boxes', 'shadows', 'tint'] as const;
export type Layer = (typeof LAYERS)[number];

/** Maximum useful distance of each level of detail from the eye, in metres; the last one has no limit. */
const USEFUL_M = [9, 25, 60, 120];
const BIN_M = 0.5;
const TINT = 0.24;
/** Bits of a person's looks. */
const COLOURED = 1;
const FADED = 2;
/** Up to this level the shadow is that of the mesh; beyond it, that of the coarse SHADOW_LEVEL. */
const MAX_LEVEL_WITH_MESH_SHADOWS = 1;
const SHADOW_LEVEL = 3;

/** Only the first shadow on a pixel counts: overlapping shadows must not add up. */
export function oncePerPixel(material: RawShaderMaterial): RawShaderMaterial {
  material.stencilWrite = true;
  material.stencilFunc = EqualStencilFunc;
  material.stencilRef = 0;
  material.stencilZPass = IncrementStencilOp;
  return material;
}

interface ModelDraws {
  lists: Instances[]; // by level of detail
  triangles: number[]; // of a body at each level
  all: Instances;
}

export class Crowd {
  readonly group = new Group();
  /** Approximate limit of body triangles per picture; adapts to the speed of the machine. */
  budget = 300_000;
  private readonly people: DataTexture;
  private parts: DataTexture | null = null; // of a server's frames
  private poser: Poser | null = null; // of a recording
  private readonly looks: DataTexture; // by avatar: colour, then the bits below
  private readonly draws: ModelDraws[] = [];
  private readonly byLayer: Record<Layer, Group> = {} as Record<Layer, Group>;
  private readonly own: Uniforms;
  private readonly frustum = new Frustum();
  private readonly sphere = new Sphere();
  private readonly visible: Uint32Array;
  private readonly binOf: Uint16Array;
  private visibleCount = 0;
  private readonly bins = new Uint32Array(Math.ceil(USEFUL_M.at(-1)! / BIN_M) + 1);
  private readonly levels = new Uint8Array(this.bins.length);

  constructor(
    private readonly run: Run,
    private readonly shared: Uniforms,
  ) {
    this.visible = new Uint32Array(run.avatars);
    this.binOf = new Uint16Array(run.avatars);
    this.people = texelMap('RGBA32UI', run.avatars);
    this.looks = texelMap('RGBA8UI', run.avatars);
    this.own = {
      uPeople: {value: this.people},
      uParts: {value: this.people},
      uLooks: {value: this.looks},
      uMarks: {value: MARK_COLORS},
      uCalm: {value: new Color('#5b6878')},
      uSelected: {value: new Vector2(-1, -1)},
      uTint: {value: TINT},
    };
    for (const [name, colors] of Object.entries(CLOTHES)) this.own[name] = {value: colors};
    for (const layer of LAYERS) {
      this.byLayer[layer] = new Group();
      this.group.add(this.byLayer[layer]);
    }
    run.models.forEach((model, index) => this.addModel(model, index));
    for (const layer of ['spheres', 'hulls', 'boxes'] as Layer[]) this.byLayer[layer].visible = false;
  }

  private material(vertexShader: string, fragmentShader: string, more: Uniforms): RawShaderMaterial {
    return shaderMaterial(vertexShader, fragmentShader, {...this.shared, ...this.own, ...more});
  }

  private addModel(model: Model, index: number): void {
    const count = this.run.modelOfAvatar.filter((m) => m === index).length;
    const step = {uPartStep: {value: model.part_step_m}};
    const body = this.material(BODY_VERTEX, BODY_FRAGMENT, step);
    const shadow = oncePerPixel(this.material(SHADOW_VERTEX, SHADOW_FRAGMENT, step));
    shadow.transparent = true;
    shadow.depthWrite = false;
    shadow.side = DoubleSide;
    const shapes = bodyGeometries(model);
    const farShadow = shadowGeometry(model);
    const lists: Instances[] = [];
    const triangles: number[] = [];
    shapes.forEach((geometry, level) => {
      const list = new Instances(count);
      this.add('meshes', new Mesh(list.drives(geometry), body));
      const outline = level <= MAX_LEVEL_WITH_MESH_SHADOWS ? shapes[SHADOW_LEVEL] : farShadow;
      this.add('shadows', new Mesh(list.drives(sharing(outline)), shadow), 1);
      lists.push(list);
      triangles.push(geometry.index!.count / 3);
    });
    const all = new Instances(count);

    const ball = new InstancedBufferGeometry();
    const shape = new IcosahedronGeometry(1, 3);
    ball.setAttribute('position', shape.getAttribute('position'));
    const spheres = this.material(SPHERE_VERTEX, SPHERE_FRAGMENT, {
      ...step,
      uSphere: {value: new Vector2(model.sphere.centre_z_m, model.sphere.radius_m)},
    });
    this.add('spheres', new Mesh(all.drives(ball), translucent(spheres)), 3);
    const hulls = translucent(this.material(HULL_VERTEX, LINE_FRAGMENT, step));
    this.add('hulls', new LineSegments(all.drives(hullGeometry(model)), hulls), 2);
    const boxes = translucent(this.material(BOX_VERTEX, LINE_FRAGMENT, step));
    this.add('boxes', new LineSegments(all.drives(boxGeometry(model)), boxes), 2);
    this.draws.push({lists, triangles, all});
  }

  private add(layer: Layer, object: Mesh | LineSegments, order = 0): void {
    object.frustumCulled = false;
    object.renderOrder = order;
    this.byLayer[layer].add(object);
  }

  show(layer: Layer, visible: boolean): void {
    if (layer === 'tint') this.own.uTint.value = visible ? TINT : 0;
    else this.byLayer[layer].visible = visible;
  }

  /** Highlights up to two people; -1 for none. */
  select(first: number, second: number): void {
    (this.own.uSelected.value as Vector2).set(first, second);
  }

  /** Fades people whose flag is 0; null ends fading. */
  setFocus(flags: Uint8Array | null): void {
    const looks = dataOf(this.looks, 'RGBA8UI');
    for (let id = 0; id < this.run.avatars; ++id)
      looks[4 * id + 3] = (looks[4 * id + 3] & ~FADED) | (flags && flags[id] === 0 ? FADED : 0);
    this.looks.needsUpdate = true;
  }

  /** Replaces clothes by sRGB colours, four bytes per person, where the fourth is 255; null restores all clothes. */
  setColors(rgba: Uint8Array | null): void {
    const looks = dataOf(this.looks, 'RGBA8UI');
    for (let at = 0; at < 4 * this.run.avatars; at += 4) {
      for (let i = 0; i < 3; ++i) looks[at + i] = rgba ? rgba[at + i] : 0;
      looks[at + 3] = (looks[at + 3] & ~COLOURED) | (rgba && rgba[at + 3] === 255 ? COLOURED : 0);
    }
    this.looks.needsUpdate = true;
  }

  setCalm(color: string): void {
    (this.own.uCalm.value as Color).set(color);
  }

  take(frame: Frame): void {
    dataOf(this.people, 'RGBA32UI').set(frame.people);
    this.people.needsUpdate = true;
    if (frame.motion) {
      this.poser ??= new Poser(this.run, frame.motion);
      this.own.uParts.value = this.poser.texture;
      return;
    }
    this.parts ??= texelMap('RGBA32UI', this.run.firstPart[this.run.avatars]);
    this.own.uParts.value = this.parts;
    dataOf(this.parts, 'RGBA32UI').set(frame.parts);
    this.parts.needsUpdate = true;
  }

  /** Computes the poses of visible people, if the frame leaves that to the graphics card. */
  pose(renderer: WebGLRenderer): void {
    this.poser?.update(renderer);
  }

  /** Computes again what the graphics card has lost. */
  restore(): void {
    this.poser?.restore();
  }

  /** Assigns a level of detail to each visible person: the nearer the finer, within the budget. */
  arrange(frame: Frame, camera: Camera, triangles: number): void {
    this.frustum.setFromProjectionMatrix(
      new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse),
    );
    this.findVisible(frame, camera);
    const levels = this.levelsByBin(triangles);
    for (const draw of this.draws) {
      draw.all.clear();
      for (const list of draw.lists) list.clear();
    }
    for (let i = 0; i < this.visibleCount; ++i) {
      const id = this.visible[i];
      const draw = this.draws[this.run.modelOfAvatar[id]];
      draw.all.add(this.run, id);
      draw.lists[levels[this.binOf[i]]].add(this.run, id);
    }
    for (const draw of this.draws) {
      draw.all.done();
      for (const list of draw.lists) list.done();
    }
  }

  private findVisible(frame: Frame, camera: Camera): void {
    const at = frame.positions;
    const drawn = this.poser?.drawnFlags;
    drawn?.fill(0);
    this.visibleCount = 0;
    this.bins.fill(0);
    for (let id = 0, word = 0; id < frame.avatars; ++id, word += 4) {
      if (!isPresent(frame, id)) continue;
      const reach = this.run.models[this.run.modelOfAvatar[id]].sphere.radius_m * this.run.scaleOfAvatar[id];
      this.sphere.center.set(at[word], at[word + 1], at[word + 2] + 0.5 * reach);
      // The shadow may be in the picture while its person is not.
      this.sphere.radius = 2.2 * reach;
      if (!this.frustum.intersectsSphere(this.sphere)) continue;
      const away = this.sphere.center.distanceTo(camera.position);
      const bin = Math.min(this.bins.length - 1, Math.floor(away / BIN_M));
      ++this.bins[bin];
      this.binOf[this.visibleCount] = bin;
      this.visible[this.visibleCount++] = id;
      if (drawn) drawn[id] = 1;
    }
  }

  /** Returns the level of detail of each ring around the eye; rings shrink until the budget holds. */
  private levelsByBin(budget: number): Uint8Array {
    let [low, high] = [0, 1];
    if (this.fillLevels(high) <= budget) return this.levels;
    for (let i = 0; i < 10; ++i) {
      const middle = (low + high) / 2;
      if (this.fillLevels(middle) <= budget) low = middle;
      else high = middle;
    }
    this.fillLevels(low);
    return this.levels;
  }

  /** Fills the levels with all useful distances scaled by `nearer`; returns their triangle count. */
  private fillLevels(nearer: number): number {
    const {triangles} = this.draws[0];
    let level = 0;
    let cost = 0;
    for (let bin = 0; bin < this.bins.length; ++bin) {
      while (level < USEFUL_M.length && bin * BIN_M >= nearer * USEFUL_M[level]) ++level;
      this.levels[bin] = level;
      cost += this.bins[bin] * triangles[level];
    }
    return cost;
  }

  dispose(): void {
    this.people.dispose();
    this.parts?.dispose();
    this.poser?.dispose();
    this.looks.dispose();
    this.group.traverse((object) => {
      if (object instanceof Mesh || object instanceof LineSegments) {
        object.geometry.dispose();
        (object.material as RawShaderMaterial).dispose();
      }
    });
  }
}

function translucent(material: RawShaderMaterial): RawShaderMaterial {
  material.transparent = true;
  material.depthWrite = false;
  return material;
}
