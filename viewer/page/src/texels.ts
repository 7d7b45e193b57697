// Textures whose texels are data; shaders read them by index.
import {
  DataTexture,
  FloatType,
  NearestFilter,
  RGBAFormat,
  RGBAIntegerFormat,
  RedIntegerFormat,
  ShortType,
  UnsignedByteType,
  UnsignedIntType,
  WebGLRenderTarget,
} from 'three';

export const TEXTURE_WIDTH = 1024;

const KINDS = {
  RGBA32UI: [Uint32Array, 4, RGBAIntegerFormat, UnsignedIntType],
  RGBA8UI: [Uint8Array, 4, RGBAIntegerFormat, UnsignedByteType],
  RGBA16I: [Int16Array, 4, RGBAIntegerFormat, ShortType],
  RGBA32F: [Float32Array, 4, RGBAFormat, FloatType],
  R8UI: [Uint8Array, 1, RedIntegerFormat, UnsignedByteType],
} as const;
type Kind = keyof typeof KINDS;
type Data<K extends Kind> = InstanceType<(typeof KINDS)[K][0]>;

const rowsOf = (texels: number): number => Math.max(1, Math.ceil(texels / TEXTURE_WIDTH));

/** Returns a texture of at least this many texels. */
export function texelMap(kind: Kind, texels: number): DataTexture {
  const [Numbers, channels, format, type] = KINDS[kind];
  const data = new Numbers(TEXTURE_WIDTH * rowsOf(texels) * channels);
  const map = new DataTexture(data, TEXTURE_WIDTH, rowsOf(texels), format, type);
  map.internalFormat = kind;
  map.minFilter = map.magFilter = NearestFilter;
  map.unpackAlignment = 1;
  map.needsUpdate = true;
  return map;
}

/** Returns the numbers of a texture. */
export function dataOf<K extends Kind>(map: DataTexture, _kind: K): Data<K> {
  return map.image.data as unknown as Data<K>;
}

/** Returns a texture of at least this many RGBA32UI texels that shaders write. */
export function texelTarget(texels: number): WebGLRenderTarget {
  return new WebGLRenderTarget(TEXTURE_WIDTH, rowsOf(texels), {
    format: RGBAIntegerFormat,
    type: UnsignedIntType,
    internalFormat: 'RGBA32UI',
    minFilter: NearestFilter,
    magFilter: NearestFilter,
    depthBuffer: false,
  });
}
