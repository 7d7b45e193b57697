// Crowd draws the people of a run: bodies by distance, shadows, spheres, or-DOPs and boxes.
// Invariant: a frame costs at most two texture copies; the size in the picture decides the level of detail.
import {
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
  PerspectiveCamera,
  RawShaderMaterial,
  SRGBColorSpace,
  Vector2,
  Vector3,
  type DataTexture,
  type WebGLRenderer,
} from 'three';
import {PeopleList, bodyLevels, boxGeometry, hullGeometry} from './bodies.ts';
import {Poser} from './poser.ts';
import type {Frame, Model, Run} from './protocol.ts';
import {
  BODY_FRAGMENT,
  BODY_VERTEX,
  BOX_VERTEX,
  HULL_VERTEX,
  LINE_FRAGMENT,
  SHADOW_FRAGMENT,
  SHADOW_VERTEX,
  SPHERE_FRAGMENT,
  RIBBON_PEOPLE,
  SPHERE_VERTEX,
  ribbonVertex,
  shaderMaterial,
  type Uniforms,
} from './shaders.ts';
import {dataOf, texelMap} from './texels.ts';
import {CLOTHES, MARK_COLORS, clothesOf} from './theme.ts';

export const LAYERS = ['meshes', 'spheres', 'hulls', 'boxes', 'shadows', 'tint'] as const;
export type Layer = (typeof LAYERS)[number];

/** Least height of people in pixels for each level of detail, finest first; a small budget increases it. */
const USEFUL_PX = [190, 70, 32, 18, 9, 0];
/** Height as a share of the picture from which people have a level of detail in spite of the budget. */
const CERTAIN_SHARE = [0.7, 0.4, 0.15, 0.08, Infinity, 0];
/** Height of a person in radii of the sphere. */
const HEIGHT = 1.8;
/** Sizes are counted in bins: the exponent and three bits of the mantissa of a float, from one pixel on. */
const BIN_SHIFT = 20;
const ONE_PIXEL = 0x3f800000 >>> BIN_SHIFT;
const BINS = 14 * 8;
const TINT = 0.24;
/** Square roots of linear colours by their sRGB value, both from 0 to 255: shaders square them, which is cheap. */
const ROOTS = Uint8Array.from({length: 256}, (_, i) => {
  const linear = new Color().setRGB(i / 255, 0, 0, SRGBColorSpace).r;
  return Math.round(255 * Math.sqrt(linear));
});
/** Bits of a person's looks. */
const COLOURED = 1;
const FADED = 2;
/** Only the first shadow on a pixel counts: overlapping shadows must not add up. */
export function oncePerPixel(material: RawShaderMaterial): RawShaderMaterial {
  material.stencilWrite = true;
  material.stencilFunc = EqualStencilFunc;
  material.stencilRef = 0;
  material.stencilZPass = IncrementStencilOp;
  return material;
}

interface ModelDraws {
  members: number;
  lists: PeopleList[]; // by level of detail
  triangles: number[]; // of a body and its shadow at each level
  all: PeopleList;
}

export class Crowd {
  readonly group = new Group();
  /** Approximate limit of body triangles per picture; adapts to the speed of the machine. */
  budget = 300_000;
  private readonly people: DataTexture;
  private parts: DataTexture | null = null; // of a server's frames
  private poser: Poser | null = null; // of a recording
  private frame: Frame | null = null;
  private readonly looks: DataTexture; // by avatar: roots of its colour, then the bits above
  private readonly ordered: DataTexture; // people in the picture, list by list
  private readonly draws: ModelDraws[] = [];
  private readonly byLayer: Record<Layer, Group> = {} as Record<Layer, Group>;
  private readonly shown: Record<Layer, boolean> = {
    meshes: true,
    spheres: false,
    hulls: false,
    boxes: false,
    shadows: true,
    tint: false,
  };
  private readonly own: Uniforms;
  private readonly frustum = new Frustum();
  private readonly planes = new Float64Array(24);
  private readonly size = new Float32Array(1);
  private readonly sizeBits = new Uint32Array(this.size.buffer);
  private readonly matrix = new Matrix4();
  private readonly clothes: Uint16Array;
  private readonly reachOf: Float32Array; // radius of each avatar's sphere
  private readonly triangles: number[]; // of a person at each level, on average over the models
  private readonly visible: Uint32Array;
  private readonly binOf: Uint16Array;
  private visibleCount = 0;
  private readonly bins = new Uint32Array(BINS); // number of people by size
  private readonly levels = new Uint8Array(this.bins.length);

  constructor(
    private readonly run: Run,
    private readonly shared: Uniforms,
  ) {
    this.visible = new Uint32Array(run.avatars);
    this.binOf = new Uint16Array(run.avatars);
    this.people = texelMap('RGBA32UI', run.avatars);
    this.looks = texelMap('RGBA8UI', run.avatars);
    this.ordered = texelMap('RGBA32F', run.avatars + RIBBON_PEOPLE * USEFUL_PX.length * run.models.length);
    this.own = {
      uPeople: {value: this.people},
      uOrder: {value: this.ordered},
      uParts: {value: this.people},
      uLooks: {value: this.looks},
      uMarks: {value: MARK_COLORS},
      uClothes: {value: CLOTHES},
      uCalm: {value: new Color('#5b6878')},
      uSelected: {value: new Vector2(-1, -1)},
      uTint: {value: TINT},
    };
    for (const layer of LAYERS) {
      this.byLayer[layer] = new Group();
      this.group.add(this.byLayer[layer]);
    }
    run.models.forEach((model, index) => this.addModel(model, index));
    this.clothes = Uint16Array.from({length: run.avatars}, (_, id) => clothesOf(id));
    this.reachOf = Float32Array.from(run.modelOfAvatar, (m, id) => run.models[m].sphere.radius_m * run.scaleOfAvatar[id]);
    this.triangles = USEFUL_PX.map((_, level) =>
      this.draws.reduce((sum, {triangles, members}) => sum + (triangles[level] * members) / Math.max(1, run.avatars), 0),
    );
    for (const layer of LAYERS) this.show(layer, this.shown[layer]);
  }

  private material(vertexShader: string, fragmentShader: string, more: Uniforms): RawShaderMaterial {
    return shaderMaterial(vertexShader, fragmentShader, {...this.shared, ...this.own, ...more});
  }

  private addModel(model: Model, index: number): void {
    const step = {uPartStep: {value: model.part_step_m}};
    const levels = bodyLevels(model);
    const lists = levels.map(({body, shadow, isRibbon}) => {
      const list = new PeopleList();
      this.add('meshes', new Mesh(list.drives(body), this.bodyMaterial(isRibbon.body, {...step, uFirst: list.first})));
      this.add('shadows', new Mesh(list.drives(shadow), this.shadowMaterial(isRibbon.shadow, {...step, uFirst: list.first})), 1);
      return list;
    });
    const all = new PeopleList();
    const more = {...step, uFirst: all.first};

    const ball = new InstancedBufferGeometry();
    const shape = new IcosahedronGeometry(1, 3);
    ball.setAttribute('position', shape.getAttribute('position'));
    const spheres = this.material(SPHERE_VERTEX, SPHERE_FRAGMENT, {
      ...more,
      uSphere: {value: new Vector2(model.sphere.centre_z_m, model.sphere.radius_m)},
    });
    this.add('spheres', new Mesh(all.drives(ball), translucent(spheres)), 3);
    const hulls = translucent(this.material(HULL_VERTEX, LINE_FRAGMENT, more));
    this.add('hulls', new LineSegments(all.drives(hullGeometry(model)), hulls), 2);
    const boxes = translucent(this.material(BOX_VERTEX, LINE_FRAGMENT, more));
    this.add('boxes', new LineSegments(all.drives(boxGeometry(model)), boxes), 2);
    const members = this.run.modelOfAvatar.filter((m) => m === index).length;
    this.draws.push({members, lists, triangles: levels.map(({triangles}) => triangles), all});
  }

  private bodyMaterial(isRibbon: boolean, more: Uniforms): RawShaderMaterial {
    const material = this.material(isRibbon ? ribbonVertex(BODY_VERTEX) : BODY_VERTEX, BODY_FRAGMENT, more);
    if (isRibbon) material.side = DoubleSide;
    return material;
  }

  private shadowMaterial(isRibbon: boolean, more: Uniforms): RawShaderMaterial {
    const material = this.material(isRibbon ? ribbonVertex(SHADOW_VERTEX) : SHADOW_VERTEX, SHADOW_FRAGMENT, more);
    material.transparent = true;
    material.depthWrite = false;
    material.side = DoubleSide;
    return oncePerPixel(material);
  }

  private add(layer: Layer, object: Mesh | LineSegments, order = 0): void {
    object.frustumCulled = false;
    object.renderOrder = order;
    this.byLayer[layer].add(object);
  }

  show(layer: Layer, visible: boolean): void {
    if (layer === 'tint') this.own.uTint.value = visible ? TINT : 0;
    this.shown[layer] = visible;
    if (visible && (layer === 'tint' || layer === 'spheres') && this.frame) this.take(this.frame);
    for (const name of LAYERS) this.byLayer[name].visible = this.shown[name];
    // Hidden bodies cast no shadow.
    this.byLayer.shadows.visible &&= this.shown.meshes;
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
      for (let i = 0; i < 3; ++i) looks[at + i] = rgba ? ROOTS[rgba[at + i]] : 0;
      looks[at + 3] = (looks[at + 3] & ~COLOURED) | (rgba && rgba[at + 3] === 255 ? COLOURED : 0);
    }
    this.looks.needsUpdate = true;
  }

  setCalm(color: string): void {
    (this.own.uCalm.value as Color).set(color);
  }

  take(frame: Frame): void {
    this.frame = frame;
    if (this.shown.spheres || this.shown.tint) frame.motion?.markCrowded();
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

  /** Assigns a level of detail to each visible person: the larger the finer, within the budget. */
  arrange(frame: Frame, camera: PerspectiveCamera, triangles: number, height_px: number): void {
    this.frustum.setFromProjectionMatrix(
      this.matrix.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse),
    );
    this.findVisible(frame, camera.position, (0.5 * height_px) / Math.tan((0.5 * camera.fov * Math.PI) / 180));
    const levels = this.levelsByBin(triangles, height_px);
    this.order(levels);
  }

  /** Orders visible people by model and level of detail; -1 fills the last instance of a list. */
  private order(levels: Uint8Array): void {
    const {run, draws, visible, binOf, visibleCount} = this;
    const texels = dataOf(this.ordered, 'RGBA32F');
    for (const {lists} of draws) for (const list of lists) list.count = 0;
    for (let i = 0; i < visibleCount; ++i) ++draws[run.modelOfAvatar[visible[i]]].lists[levels[binOf[i]]].count;
    let end = 0;
    for (const {lists, all} of draws) {
      const start = end;
      for (const list of lists) {
        const first = end;
        end = list.place(first);
        for (let i = first + list.count; i < end; ++i) texels[4 * i] = -1;
        list.count = 0;
      }
      all.count = end - start;
      all.place(start);
    }
    for (let i = 0; i < visibleCount; ++i) {
      const id = visible[i];
      const list = draws[run.modelOfAvatar[id]].lists[levels[binOf[i]]];
      const at = 4 * (list.first.value + list.count++);
      texels[at] = id;
      texels[at + 1] = run.firstPart[id];
      texels[at + 2] = run.scaleOfAvatar[id];
      texels[at + 3] = this.clothes[id];
    }
    this.ordered.needsUpdate = true;
  }

  /** `focus_px` is the size in pixels of a metre one metre ahead. */
  private findVisible(frame: Frame, eye: Vector3, focus_px: number): void {
    const {run, reachOf, planes, visible, binOf, bins, size, sizeBits} = this;
    const {positions, people} = frame;
    const drawn = this.poser?.drawnFlags;
    drawn?.fill(0);
    bins.fill(0);
    this.frustum.planes.forEach(({normal, constant}, i) => planes.set([normal.x, normal.y, normal.z, constant], 4 * i));
    let count = 0;
    for (let id = 0, word = 0; id < run.avatars; ++id, word += 4) {
      if ((people[word + 3] & 1) === 0) continue;
      const reach = reachOf[id];
      const x = positions[word];
      const y = positions[word + 1];
      const z = positions[word + 2] + 0.5 * reach;
      // The shadow may be in the picture while its person is not.
      const limit = -2.2 * reach;
      let plane = 0;
      while (plane < 24 && planes[plane] * x + planes[plane + 1] * y + planes[plane + 2] * z + planes[plane + 3] >= limit) plane += 4;
      if (plane < 24) continue;
      const away = Math.sqrt((x - eye.x) ** 2 + (y - eye.y) ** 2 + (z - eye.z) ** 2);
      size[0] = (HEIGHT * reach * focus_px) / Math.max(away, 1e-3);
      const bin = Math.min(BINS - 1, Math.max(0, (sizeBits[0] >>> BIN_SHIFT) - ONE_PIXEL));
      ++bins[bin];
      binOf[count] = bin;
      visible[count++] = id;
      if (drawn) drawn[id] = 1;
    }
    this.visibleCount = count;
  }

  /** Returns the level of detail of each size; levels get coarser until the budget holds. */
  private levelsByBin(budget: number, height_px: number): Uint8Array {
    let [low, high] = [0, 1];
    if (this.fillLevels(high, height_px) <= budget) return this.levels;
    for (let i = 0; i < 10; ++i) {
      const middle = (low + high) / 2;
      if (this.fillLevels(middle, height_px) <= budget) low = middle;
      else high = middle;
    }
    this.fillLevels(low, height_px);
    return this.levels;
  }

  /** Fills the levels as if people were `nearer` times as tall; returns their triangle count. */
  private fillLevels(nearer: number, height_px: number): number {
    let level = 0;
    let cost = 0;
    for (let bin = BINS - 1; bin >= 0; --bin) {
      this.sizeBits[0] = (bin + ONE_PIXEL) << BIN_SHIFT;
      const size_px = this.size[0];
      while (size_px * nearer < USEFUL_PX[level] && size_px < CERTAIN_SHARE[level] * height_px) ++level;
      this.levels[bin] = level;
      cost += this.bins[bin] * this.triangles[level];
    }
    return cost;
  }

  dispose(): void {
    this.people.dispose();
    this.parts?.dispose();
    this.poser?.dispose();
    this.looks.dispose();
    this.ordered.dispose();
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
