// Poser computes the part poses of a recording on the graphics card, from joint positions at keys.
// Invariant: texels of parts have the form of the server's; the processor computes only roots.
import {
  Camera,
  Mesh,
  NoBlending,
  PlaneGeometry,
  Vector4,
  type DataTexture,
  type RawShaderMaterial,
  type WebGLRenderer,
  type WebGLRenderTarget,
} from 'three';
import {UNIT} from './chains.ts';
import {ROOT_FLOATS, type Motion} from './motion.ts';
import type {Run} from './protocol.ts';
import {FETCH, QUATERNIONS, shaderMaterial, type Uniforms} from './shaders.ts';
import {dataOf, texelMap, texelTarget} from './texels.ts';

const VERTEX = /* glsl */ `
precision highp float;
in vec3 position;
void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }`;

const PASS = FETCH + /* glsl */ `
out uvec4 texel;
uint index() { return uint(gl_FragCoord.y) * TEXTURE_WIDTH + uint(gl_FragCoord.x); }
`;

/** Computes a key's columns: per avatar the quaternion of the root, then the joint positions, four per texel. */
const KEY_FRAGMENT = PASS + /* glsl */ `
uniform usampler2D uColumns;
uniform isampler2D uAmounts;
uniform sampler2D uRoots;
uniform sampler2D uBases;
void main() {
  uvec4 column = at(uColumns, index());
  if (column.w == 1u) {
    vec4 first = at(uRoots, 2u * column.x);
    texel = floatBitsToUint(vec4(first.w, at(uRoots, 2u * column.x + 1u).xyz));
    return;
  }
  vec4 sum = at(uBases, column.z);
  for (uint i = 0u; i < column.y; ++i) {
    vec4 amounts = vec4(at(uAmounts, column.x + i));
    uint direction = column.z + 1u + 4u * i;
    for (uint c = 0u; c < 4u; ++c) sum += amounts[c] * at(uBases, direction + c);
  }
  texel = floatBitsToUint(sum);
}`;

/** Interpolates the columns of four keys. */
const BLEND_FRAGMENT = PASS + /* glsl */ `
uniform usampler2D uKey0;
uniform usampler2D uKey1;
uniform usampler2D uKey2;
uniform usampler2D uKey3;
uniform vec4 uWeights;
void main() {
  uint i = index();
  texel = floatBitsToUint(uWeights.x * uintBitsToFloat(at(uKey0, i)) + uWeights.y * uintBitsToFloat(at(uKey1, i)) +
                          uWeights.z * uintBitsToFloat(at(uKey2, i)) + uWeights.w * uintBitsToFloat(at(uKey3, i)));
}`;

/** Computes texels of parts along their chains of joints. */
const POSE_FRAGMENT = PASS + QUATERNIONS + /* glsl */ `
uniform usampler2D uOwners;
uniform usampler2D uBlend;
uniform usampler2D uMarks;
uniform usampler2D uDrawn;
uniform sampler2D uChains;
uint halves(float low, float high) {
  return (uint(int(floor(low + 0.5))) & 0xffffu) | (uint(int(floor(high + 0.5))) << 16u);
}
void main() {
  uvec4 owner = at(uOwners, index());
  if (at(uDrawn, owner.x).r == 0u) discard;
  uint joint = owner.y & 0xffffffu;
  uint end = joint + 2u * (owner.y >> 24u);
  vec3 x = vec3(0.0);
  vec4 q = normalize(uintBitsToFloat(at(uBlend, owner.z)));
  for (; joint < end; joint += 2u) {
    vec4 offset = at(uChains, joint);
    vec4 axis = at(uChains, joint + 1u);
    uint column = uint(offset.w);
    float value = uintBitsToFloat(at(uBlend, owner.z + 1u + (column >> 2u)))[column & 3u];
    bool slides = axis.w == 0.0;
    x += turned(q, offset.xyz + (slides ? value * axis.xyz : vec3(0.0)));
    float angle = 0.5 * axis.w * value;
    if (!slides) q = product(q, vec4(axis.xyz * sin(angle), cos(angle)));
  }
  vec4 offset = at(uChains, end);
  x = (x + turned(q, offset.xyz)) * uintBitsToFloat(owner.w) * offset.w;
  q = normalize(product(q, at(uChains, end + 1u))) * ${UNIT}.0;
  uint mark = at(uMarks, index()).r;
  texel = uvec4(halves(x.x, x.y), halves(x.z, float(mark)), halves(q.x, q.y), halves(q.z, q.w));
}`;

const SLOTS = 4;

export class Poser {
  private readonly parts: WebGLRenderTarget;
  private readonly blend: WebGLRenderTarget;
  private readonly slots: WebGLRenderTarget[];
  private readonly slotKeys = new Int32Array(SLOTS).fill(-1);
  private readonly roots: DataTexture;
  private readonly amounts: DataTexture;
  private readonly marks: DataTexture;
  private readonly drawn: DataTexture;
  private readonly statics: DataTexture[];
  private readonly weights = new Vector4();
  private marksVersion = -1;
  private readonly keyPass: RawShaderMaterial;
  private readonly blendPass: RawShaderMaterial;
  private readonly posePass: RawShaderMaterial;
  private readonly quad: Mesh;
  private readonly camera = new Camera();
  private readonly memberTexels: number[] = []; // by model: its first texel of amounts

  constructor(
    private readonly run: Run,
    private readonly motion: Motion,
  ) {
    let amounts = 0;
    motion.amountsPerMember.forEach((perMember, model) => {
      this.memberTexels.push(amounts);
      amounts += (perMember / 4) * run.modelOfAvatar.filter((m) => m === model).length;
    });
    const parts = run.firstPart[run.avatars];
    this.roots = texelMap('RGBA32F', (run.avatars * ROOT_FLOATS) / 4);
    this.amounts = texelMap('RGBA16I', amounts);
    this.marks = texelMap('R8UI', parts);
    this.drawn = texelMap('R8UI', run.avatars);
    const {bases, placeOf} = this.baseTexels();
    const {columns, firstColumn, count} = this.columnTexels(placeOf);
    const owners = this.ownerTexels(firstColumn);
    const chains = texelMap('RGBA32F', motion.chains.floats.length / 4);
    dataOf(chains, 'RGBA32F').set(motion.chains.floats);
    this.statics = [bases, columns, owners, chains];
    this.slots = Array.from({length: SLOTS}, () => texelTarget(count));
    this.blend = texelTarget(count);
    this.parts = texelTarget(parts);
    const value = <T>(of: T): {value: T} => ({value: of});
    this.keyPass = pass(KEY_FRAGMENT, {
      uColumns: value(columns),
      uAmounts: value(this.amounts),
      uRoots: value(this.roots),
      uBases: value(bases),
    });
    const [key0, key1, key2, key3] = this.slots.map(({texture}) => value(texture));
    this.blendPass = pass(BLEND_FRAGMENT, {uKey0: key0, uKey1: key1, uKey2: key2, uKey3: key3, uWeights: value(this.weights)});
    this.posePass = pass(POSE_FRAGMENT, {
      uOwners: value(owners),
      uBlend: value(this.blend.texture),
      uMarks: value(this.marks),
      uDrawn: value(this.drawn),
      uChains: value(chains),
    });
    this.quad = new Mesh(new PlaneGeometry(2, 2), this.keyPass);
    this.quad.frustumCulled = false;
  }

  /** The texels of all parts. */
  get texture(): WebGLRenderTarget['texture'] {
    return this.parts.texture;
  }

  /** One flag per avatar: whether its parts are computed. */
  get drawnFlags(): Uint8Array {
    return dataOf(this.drawn, 'R8UI');
  }

  /** Per model and texel of columns: the means, then four directions per texel of amounts. */
  private baseTexels(): {bases: DataTexture; placeOf: number[]} {
    const {bases, amountsPerMember} = this.motion;
    const floats: number[] = [];
    const placeOf = bases.map(({mean, directions}, model) => {
      const first = floats.length / 4;
      for (let column = 0; column < mean.length; column += 4) {
        const four = (row: number[] | undefined): number[] => [0, 1, 2, 3].map((i) => row?.[column + i] ?? 0);
        floats.push(...four(mean));
        for (let c = 0; c < amountsPerMember[model]; ++c) floats.push(...four(directions[c]));
      }
      return first;
    });
    const map = texelMap('RGBA32F', floats.length / 4);
    dataOf(map, 'RGBA32F').set(floats);
    return {bases: map, placeOf};
  }

  /** Per texel of columns: first texel and number of amounts, place in the bases, 0; of a root: avatar, 0, 0, 1. */
  private columnTexels(placeOf: number[]): {columns: DataTexture; firstColumn: Uint32Array; count: number} {
    const {run, motion} = this;
    const perAvatar = motion.bases.map(({mean}) => 1 + Math.ceil(mean.length / 4));
    const firstColumn = new Uint32Array(run.avatars);
    let count = 0;
    for (let id = 0; id < run.avatars; ++id) {
      firstColumn[id] = count;
      count += perAvatar[run.modelOfAvatar[id]];
    }
    const map = texelMap('RGBA32UI', count);
    const words = dataOf(map, 'RGBA32UI');
    for (let id = 0; id < run.avatars; ++id) {
      const model = run.modelOfAvatar[id];
      const texels = motion.amountsPerMember[model] / 4;
      words[4 * firstColumn[id]] = id;
      words[4 * firstColumn[id] + 3] = 1;
      for (let i = 1; i < perAvatar[model]; ++i) {
        const at = 4 * (firstColumn[id] + i);
        words[at] = this.memberTexels[model] + motion.memberOf[id] * texels;
        words[at + 1] = texels;
        words[at + 2] = placeOf[model] + (i - 1) * (1 + 4 * texels);
      }
    }
    return {columns: map, firstColumn, count};
  }

  /** Per part: avatar, chain, texel of the root and scale. */
  private ownerTexels(firstColumn: Uint32Array): DataTexture {
    const {run, motion} = this;
    const map = texelMap('RGBA32UI', run.firstPart[run.avatars]);
    const words = dataOf(map, 'RGBA32UI');
    const scales = new Float32Array(words.buffer);
    for (let id = 0, at = 0; id < run.avatars; ++id)
      for (let part = 0; part < run.firstPart[id + 1] - run.firstPart[id]; ++part, at += 4) {
        const {first, joints} = motion.chains.placeOf(run.modelOfAvatar[id], part);
        words[at] = id;
        words[at + 1] = first / 4 + joints * 2 ** 24;
        words[at + 2] = firstColumn[id];
        scales[at + 3] = run.scaleOfAvatar[id];
      }
    return map;
  }

  /** Computes the poses of drawn people at the present time of the motion. */
  update(renderer: WebGLRenderer): void {
    const {motion} = this;
    const before = renderer.getRenderTarget();
    const {autoClear} = renderer;
    renderer.autoClear = false;
    // A slot without a key must exist as well: its weight is 0.
    if (this.slotKeys.every((key) => key < 0)) for (const slot of this.slots) renderer.initRenderTarget(slot);
    this.weights.set(0, 0, 0, 0);
    motion.around.forEach((key, i) => {
      const slot = key % SLOTS;
      if (this.slotKeys[slot] !== key) this.load(renderer, key, slot);
      this.weights.setComponent(slot, this.weights.getComponent(slot) + motion.weights[i]);
    });
    this.draw(renderer, this.blendPass, this.blend);
    if (this.marksVersion !== motion.marksVersion) {
      this.marksVersion = motion.marksVersion;
      dataOf(this.marks, 'R8UI').set(motion.marks);
      this.marks.needsUpdate = true;
    }
    this.drawn.needsUpdate = true;
    this.draw(renderer, this.posePass, this.parts);
    renderer.setRenderTarget(before);
    renderer.autoClear = autoClear;
  }

  private load(renderer: WebGLRenderer, key: number, slot: number): void {
    const {motion} = this;
    this.slotKeys[slot] = key;
    dataOf(this.roots, 'RGBA32F').set(motion.rootsAt(key));
    const amounts = dataOf(this.amounts, 'RGBA16I');
    this.memberTexels.forEach((first, model) => amounts.set(motion.amountsAt(model, key), 4 * first));
    this.roots.needsUpdate = this.amounts.needsUpdate = true;
    this.draw(renderer, this.keyPass, this.slots[slot]);
  }

  private draw(renderer: WebGLRenderer, material: RawShaderMaterial, target: WebGLRenderTarget): void {
    this.quad.material = material;
    renderer.setRenderTarget(target);
    renderer.render(this.quad, this.camera);
  }

  /** Forgets what the graphics card has lost. */
  restore(): void {
    this.slotKeys.fill(-1);
  }

  dispose(): void {
    const {roots, amounts, marks, drawn, statics, slots, blend, parts} = this;
    for (const texture of [roots, amounts, marks, drawn, ...statics, ...slots, blend, parts]) texture.dispose();
    for (const material of [this.keyPass, this.blendPass, this.posePass]) material.dispose();
    this.quad.geometry.dispose();
  }
}

function pass(fragment: string, uniforms: Uniforms): RawShaderMaterial {
  const material = shaderMaterial(VERTEX, fragment, uniforms);
  material.blending = NoBlending;
  material.depthTest = material.depthWrite = false;
  return material;
}
