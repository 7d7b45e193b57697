// Shaders: poses from the frame's texels, light, lines.
// Invariant: a frame is two textures of 16-byte texels; all work per vertex is done here.

import {GLSL3, RawShaderMaterial} from 'three';
import {TEXTURE_WIDTH} from './texels.ts';
import {CHOICE_BITS, CLOTHES} from './theme.ts';

export type Uniforms = Record<string, {value: unknown}>;

export function shaderMaterial(vertexShader: string, fragmentShader: string, uniforms: Uniforms): RawShaderMaterial {
  return new RawShaderMaterial({glslVersion: GLSL3, vertexShader, fragmentShader, uniforms});
}

/** Reads a texel by its index. */
export const FETCH = /* glsl */ `
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp isampler2D;
precision highp usampler2D;
const uint TEXTURE_WIDTH = ${TEXTURE_WIDTH}u;
ivec2 place(uint index) { return ivec2(int(index % TEXTURE_WIDTH), int(index / TEXTURE_WIDTH)); }
uvec4 at(usampler2D map, uint index) { return texelFetch(map, place(index), 0); }
ivec4 at(isampler2D map, uint index) { return texelFetch(map, place(index), 0); }
vec4 at(sampler2D map, uint index) { return texelFetch(map, place(index), 0); }
`;

/** Quaternions are x, y, z, w. */
export const QUATERNIONS = /* glsl */ `
vec3 turned(vec4 q, vec3 v) {
  return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v);
}
vec4 product(vec4 a, vec4 b) {
  return vec4(a.w * b.xyz + b.w * a.xyz + cross(a.xyz, b.xyz), a.w * b.w - dot(a.xyz, b.xyz));
}
`;

/** People that a geometry of ribbons has. */
export const RIBBON_PEOPLE = 64;

/** Reads people and parts. `instance` is avatar (-1: none), first part, scale and clothes. */
const POSES = FETCH + QUATERNIONS + /* glsl */ `
uniform usampler2D uPeople;
uniform usampler2D uParts;
uniform usampler2D uLooks;
uniform float uPartStep;
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
uniform sampler2D uOrder;
uniform uint uFirst;
#ifdef RIBBON
in float member;
uint number() { return uint(gl_InstanceID) * ${RIBBON_PEOPLE}u + uint(member); }
#else
uint number() { return uint(gl_InstanceID); }
#endif
vec4 instance;

float low(uint word) { return float(int(word << 16u) >> 16); }
float high(uint word) { return float(int(word) >> 16); }

/** A colour instead of the clothes, and whether the person is out of focus. */
struct Looks { vec3 color; bool coloured; bool faded; };
Looks looks() {
  uvec4 t = at(uLooks, uint(instance.x));
  vec3 root = vec3(t.rgb) / 255.0;
  return Looks(root * root, (t.a & 1u) != 0u, (t.a & 2u) != 0u);
}
struct Person { vec3 root; bool there; bool crowded; uint mark; };
Person person() {
  instance = at(uOrder, uFirst + number());
  if (instance.x < 0.0) return Person(vec3(0.0), false, false, 0u);
  uvec4 t = at(uPeople, uint(instance.x));
  return Person(uintBitsToFloat(t.xyz), (t.w & 1u) != 0u, (t.w & 2u) != 0u, (t.w >> 8u) & 255u);
}
struct Pose { vec3 origin; vec4 q; uint mark; };
Pose pose(float part) {
  uvec4 t = at(uParts, uint(instance.y + part));
  vec3 origin = vec3(low(t.x), high(t.x), low(t.y)) * uPartStep;
  return Pose(origin, normalize(vec4(low(t.z), high(t.z), low(t.w), high(t.w))), t.y >> 16u);
}
vec3 placed(Person who, Pose p, vec3 local) {
  return who.root + p.origin + turned(p.q, local * instance.z);
}
const float FADED_LINES = 0.25;
const vec4 OUTSIDE_CLIP = vec4(2.0, 2.0, 2.0, 1.0);
`;

/** Projects a point along the sun's rays onto z = 0, slightly above the drawn ground. */
const SHADE = /* glsl */ `
uniform vec3 uSun;
vec4 shade(vec3 world) {
  world -= uSun * (max(0.0, world.z) / uSun.z);
  return vec4(world.xy, 0.004, 1.0);
}
`;

/** Without divisions and branches: where the processor draws, these cost more than the rest of a vertex. */
const COLORS = /* glsl */ `
uniform vec3 uMarks[5];
uniform vec3 uClothes[${CLOTHES.length}];
uniform float uTint;
vec3 clothes(uint slot) {
  uint choice = (uint(instance.w) >> (${CHOICE_BITS}u * slot)) & ${(1 << CHOICE_BITS) - 1}u;
  return uClothes[(slot << ${CHOICE_BITS}u) + choice];
}
`;

export const BODY_VERTEX = POSES + COLORS + /* glsl */ `
in vec3 position;
in vec3 normal;
in vec2 partSlot;
#ifdef RIBBON
in vec2 edge;
uniform vec3 uEye;
#endif
uniform vec2 uSelected;
out vec3 vNormal;
out vec3 vColor;
out vec3 vWorld;
out float vMarked;
out float vSelected;
out float vFaded;
void main() {
  Person who = person();
  if (!who.there) { gl_Position = OUTSIDE_CLIP; return; }
  Pose p = pose(partSlot.x);
  vec3 world = placed(who, p, position);
  vNormal = turned(p.q, normal);
#ifdef RIBBON
  vec3 toEye = normalize(uEye - world);
  float facing = dot(vNormal, toEye);
  vec3 along = vNormal - facing * toEye;
  // From exactly ahead, a ribbon may lie in any direction.
  along = length(along) > 1e-3 ? normalize(along) : normalize(cross(toEye, vec3(0.31, 0.95, 0.02)));
  vec3 aside = cross(along, toEye);
  world += instance.z * (edge.x * aside + abs(facing) * edge.y * along);
  // As round as the limb that it replaces.
  vNormal = normalize(toEye + 0.8 * sign(edge.x) * aside);
#endif
  vWorld = world;
  uint mark = max(p.mark, who.mark == 1u || who.mark == 2u ? who.mark : 0u);
  vec3 cloth = clothes(uint(partSlot.y));
  Looks look = looks();
  // Shades of trousers would not match the legend, but without any difference people look like pawns.
  if (look.coloured && partSlot.y < 1.5)
    cloth = look.color * (partSlot.y < 0.5 ? 1.0 : 0.85);
  else if (who.crowded) cloth = mix(cloth, uMarks[0], uTint);
  vMarked = mark > 0u ? 1.0 : 0.0;
  vColor = mark > 0u ? uMarks[mark] : cloth;
  vSelected = instance.x == uSelected.x || instance.x == uSelected.y ? 1.0 : 0.0;
  vFaded = look.faded ? 1.0 : 0.0;
  gl_Position = projectionMatrix * viewMatrix * vec4(world, 1.0);
}`;

/** Roots instead of the power 1/2.4, which costs much in software: within a tenth of a step of 1/255. */
const SRGB = /* glsl */ `
vec4 shown(vec3 linear, float alpha) {
  vec3 c = clamp(linear, 0.0, 1.0);
  vec3 root = sqrt(c);
  vec3 curve = 0.833751 * root + 0.298112 * sqrt(root) - 0.0553185 * c - 0.0769049;
  return vec4(mix(c * 12.92, curve, step(0.0031308, c)), alpha);
}
`;

const LIGHT = /* glsl */ `
uniform vec3 uSun;
uniform vec3 uSky;
uniform vec3 uEarth;
uniform vec3 uSunColor;
uniform vec3 uFog;
uniform vec2 uFogRange;
uniform vec3 uEye;
vec3 lit(vec3 color, vec3 n, vec3 world) {
  float up = 0.5 + 0.5 * n.z;
  float sun = max(0.0, dot(n, uSun));
  float near = mix(0.72, 1.0, smoothstep(0.0, 1.1, world.z));
  return color * (mix(uEarth, uSky, up) * near + uSunColor * sun);
}
vec3 fogged(vec3 color, vec3 world) {
  return mix(color, uFog, smoothstep(uFogRange.x, uFogRange.y, distance(world, uEye)));
}
` + SRGB;

export const BODY_FRAGMENT = /* glsl */ `
precision highp float;
in vec3 vNormal;
in vec3 vColor;
in vec3 vWorld;
in float vMarked;
in float vSelected;
in float vFaded;
uniform vec3 uFaded;
uniform float uSeesThrough;
uniform vec3 uChosen;
out vec4 fragment;
` + LIGHT + /* glsl */ `
void main() {
  // Every second pixel of people who may hide the selected ones.
  if (vFaded * uSeesThrough > 0.5 && ((int(gl_FragCoord.x) + int(gl_FragCoord.y)) & 1) == 0) discard;
  vec3 n = normalize(vNormal);
  vec3 toEye = normalize(uEye - vWorld);
  float edge = 1.0 - max(0.0, dot(n, toEye));
  float rim = edge * edge * edge;
  vec3 color = lit(vColor, n, vWorld);
  // Touching parts glow a little, so that shadow does not hide them in a crowd.
  color += vColor * vMarked * 0.28 + uSky * rim * 0.16;
  // Some light remains, which keeps people recognisable as people.
  if (vFaded > 0.5) color = mix(color, uFaded * (0.88 + 0.24 * n.z * n.z), 0.8);
  // Touching parts of a selected person keep most of their colour.
  if (vSelected > 0.5) color = mix(color, uChosen, (0.04 + 0.85 * edge * edge) * (1.0 - 0.6 * vMarked));
  fragment = shown(fogged(color, vWorld), 1.0);
}`;

export const SHADOW_VERTEX = POSES + SHADE + /* glsl */ `
in vec3 position;
in vec2 partSlot;
#ifdef RIBBON
in vec3 normal;
in vec2 edge;
#endif
uniform float uSeesThrough;
void main() {
  Person who = person();
  // The shadows of bodies that are seen through would hide what is behind.
  if (!who.there || (uSeesThrough > 0.5 && looks().faded)) { gl_Position = OUTSIDE_CLIP; return; }
  Pose p = pose(partSlot.x);
  vec4 ground = shade(placed(who, p, position));
#ifdef RIBBON
  vec3 axis = turned(p.q, normal);
  vec2 along = axis.xy - uSun.xy * (axis.z / uSun.z);
  ground.xy += instance.z * edge.x * vec2(-along.y, along.x) / max(length(along), 1e-3);
#endif
  gl_Position = projectionMatrix * viewMatrix * ground;
}`;

/** Returns a vertex shader of bodies or shadows for ribbons, which turn to the eye. */
export function ribbonVertex(shader: string): string {
  return `#define RIBBON\n${shader}`;
}

export const FLAT_SHADOW_VERTEX = /* glsl */ `
precision highp float;
uniform mat4 modelMatrix;
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
in vec3 position;
` + SHADE + /* glsl */ `
void main() {
  gl_Position = projectionMatrix * viewMatrix * shade((modelMatrix * vec4(position, 1.0)).xyz);
}`;

export const SHADOW_FRAGMENT = /* glsl */ `
precision highp float;
uniform vec4 uShadow;
out vec4 fragment;
void main() { fragment = uShadow; }`;

/** Avatar spheres: instanced unit spheres, visible at their rims. */
export const SPHERE_VERTEX = POSES + /* glsl */ `
in vec3 position;
uniform vec2 uSphere;
uniform vec3 uMarks[5];
uniform vec3 uCalm;
out vec3 vNormal;
out vec3 vWorld;
out vec3 vColor;
out float vStrength;
void main() {
  Person who = person();
  if (!who.there) { gl_Position = OUTSIDE_CLIP; return; }
  vec3 centre = who.root + vec3(0.0, 0.0, uSphere.x * instance.z);
  vWorld = centre + position * uSphere.y * instance.z;
  vNormal = position;
  vColor = who.crowded ? uMarks[0] : uCalm;
  vStrength = (who.crowded ? 1.0 : 0.6) * (looks().faded ? FADED_LINES : 1.0);
  gl_Position = projectionMatrix * viewMatrix * vec4(vWorld, 1.0);
}`;

export const SPHERE_FRAGMENT = /* glsl */ `
precision highp float;
uniform vec3 uEye;
in vec3 vNormal;
in vec3 vWorld;
in vec3 vColor;
in float vStrength;
out vec4 fragment;
` + SRGB + /* glsl */ `
void main() {
  float rim = 1.0 - abs(dot(normalize(vNormal), normalize(uEye - vWorld)));
  fragment = shown(vColor, vStrength * (0.05 + 0.55 * rim * rim * rim * rim));
}`;

/** Or-DOP lines, which turn with their part. */
export const HULL_VERTEX = POSES + /* glsl */ `
in vec3 position;
in float part;
uniform vec3 uMarks[5];
uniform vec3 uCalm;
out vec4 vColor;
void main() {
  Person who = person();
  if (!who.there) { gl_Position = OUTSIDE_CLIP; return; }
  Pose p = pose(part);
  vec3 world = placed(who, p, position);
  vColor = p.mark > 0u ? vec4(uMarks[p.mark], 1.0) : vec4(uCalm, 0.55);
  if (looks().faded) vColor.a *= FADED_LINES;
  gl_Position = projectionMatrix * viewMatrix * vec4(world, 1.0);
}`;

/** World-aligned boxes of the oriented part boxes (Arvo 1990). */
export const BOX_VERTEX = POSES + /* glsl */ `
in vec3 position;
in vec3 centre;
in vec3 halfSize;
in float part;
uniform vec3 uMarks[5];
uniform vec3 uCalm;
out vec4 vColor;
void main() {
  Person who = person();
  if (!who.there) { gl_Position = OUTSIDE_CLIP; return; }
  Pose p = pose(part);
  vec3 x = turned(p.q, vec3(1.0, 0.0, 0.0)), y = turned(p.q, vec3(0.0, 1.0, 0.0));
  vec3 z = turned(p.q, vec3(0.0, 0.0, 1.0));
  vec3 reach = abs(x) * halfSize.x + abs(y) * halfSize.y + abs(z) * halfSize.z;
  vec3 world = who.root + p.origin + (turned(p.q, centre) + position * reach) * instance.z;
  vColor = p.mark > 0u ? vec4(uMarks[p.mark], 1.0) : vec4(uCalm, 0.4);
  if (looks().faded) vColor.a *= FADED_LINES;
  gl_Position = projectionMatrix * viewMatrix * vec4(world, 1.0);
}`;

export const LINE_FRAGMENT = /* glsl */ `
precision highp float;
in vec4 vColor;
out vec4 fragment;
` + SRGB + /* glsl */ `
void main() { fragment = shown(vColor.rgb, vColor.a); }`;

export const SOLID_VERTEX = /* glsl */ `
precision highp float;
uniform mat4 modelMatrix;
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
in vec3 position;
in vec3 normal;
out vec3 vNormal;
out vec3 vWorld;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  vWorld = world.xyz;
  vNormal = mat3(modelMatrix) * normal;
  gl_Position = projectionMatrix * viewMatrix * world;
}`;

export const SOLID_FRAGMENT = /* glsl */ `
precision highp float;
in vec3 vNormal;
in vec3 vWorld;
uniform vec3 uColor;
uniform float uAlpha;
out vec4 fragment;
` + LIGHT + /* glsl */ `
void main() {
  fragment = shown(fogged(lit(uColor, normalize(vNormal), vWorld), vWorld), uAlpha);
}`;

/** Lines every metre and every ten metres, as sharp as pixels allow; the scene's ground is a little lighter. */
export const GROUND_FRAGMENT = /* glsl */ `
precision highp float;
in vec3 vNormal;
in vec3 vWorld;
uniform vec3 uGround;
uniform vec3 uBeyond;
uniform vec3 uLine;
uniform vec4 uBounds;
out vec4 fragment;
` + LIGHT + /* glsl */ `
float lines(vec2 at, float every) {
  vec2 p = at / every;
  vec2 width = fwidth(p);
  vec2 away = abs(fract(p - 0.5) - 0.5) / max(width, vec2(1e-6));
  float line = 1.0 - min(min(away.x, away.y), 1.0);
  return line * (1.0 - smoothstep(0.25, 0.6, max(width.x, width.y)));
}
void main() {
  vec2 at = vWorld.xy;
  vec2 outside = max(uBounds.xy - at, at - uBounds.zw);
  float edge = max(outside.x, outside.y);
  float soft = fwidth(edge);
  float inside = 1.0 - smoothstep(-soft, soft, edge);
  vec3 color = mix(uBeyond, uGround, inside);
  float strength = 0.16 * lines(at, 1.0) * inside + 0.34 * lines(at, 10.0);
  color = mix(color, uLine, strength);
  color = mix(color, uLine, 0.6 * (1.0 - smoothstep(0.0, 1.5 * soft + 0.015, abs(edge))));
  fragment = shown(fogged(color, vWorld), 1.0);
}`;

/** Copies a picture of the same size. */
export const COPY_VERTEX = /* glsl */ `
precision highp float;
in vec3 position;
void main() { gl_Position = vec4(position, 1.0); }`;

export const COPY_FRAGMENT = /* glsl */ `
precision highp float;
uniform sampler2D uPicture;
out vec4 fragment;
void main() { fragment = texelFetch(uPicture, ivec2(gl_FragCoord.xy), 0); }`;
