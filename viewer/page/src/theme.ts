// Colours. Contacts have Okabe and Ito's palette, safe for colour-blind readers; the rest is muted.
import {Color} from 'three';
import palette from './palette.json'; // shared with throng render

export type ThemeName = 'light' | 'dark';

/** By mark: 0 for sphere candidates, else 1 + the level at which a pair was decided. */
export const MARKS = [
  {color: palette.marks[0], name: 'Sphere candidate', about: "the person's sphere overlaps another's"},
  {color: palette.marks[1], name: 'Spheres only', about: 'a pair of people, not refined within the budget'},
  {color: palette.marks[2], name: 'Boxes only', about: 'a pair of parts, not refined within the budget'},
  {color: palette.marks[3], name: 'or-DOP pair', about: "the parts' volumes overlap"},
  {color: palette.marks[4], name: 'Exact contact', about: 'triangles of the parts intersect'},
];

export interface Theme {
  fog: string;
  ground: string;
  beyond: string;
  line: string;
  solid: string;
  calm: string;
  /** People out of focus. */
  faded: string;
  /** Selected people and obstacles. */
  chosen: string;
  sky: Color;
  earth: Color;
  sun: Color;
  shadow: [number, number, number, number];
}

export const THEMES: Record<ThemeName, Theme> = {
  light: {
    fog: '#e9eef4',
    ground: '#dfe3e8',
    beyond: '#d3d9e0',
    line: '#8d99a8',
    solid: '#b9b3a9',
    calm: '#5b6878',
    faded: '#ccd3db',
    chosen: '#cc79a7',
    sky: new Color(0.62, 0.66, 0.72),
    earth: new Color(0.3, 0.29, 0.28),
    sun: new Color(0.62, 0.58, 0.5),
    shadow: [0.1, 0.14, 0.22, 0.3],
  },
  dark: {
    fog: '#0d1219',
    ground: '#1a222d',
    beyond: '#131a23',
    line: '#4f6176',
    solid: '#4c545f',
    calm: '#8fa3ba',
    faded: '#253140',
    chosen: '#b4608f',
    sky: new Color(0.4, 0.46, 0.56),
    earth: new Color(0.13, 0.13, 0.16),
    sun: new Color(0.58, 0.54, 0.48),
    shadow: [0, 0, 0.02, 0.5],
  },
};

/** Muted clothes, because touching parts have to stand out. By slot: shirt, trousers, skin, hair, shoes. */
const WARDROBE = [palette.shirts, palette.trousers, palette.skins, palette.hairs, palette.shoes];
/** Bits of a chosen colour. */
export const CHOICE_BITS = 3;

/** Colours by slot, 2^CHOICE_BITS each. */
export const CLOTHES = WARDROBE.flatMap((colors) =>
  Array.from({length: 1 << CHOICE_BITS}, (_, i) => new Color(colors[i % colors.length])),
);

function scatter(id: number): number {
  let x = id;
  x = Math.imul(x ^ (x >>> 16), 0x7feb352d);
  x = Math.imul(x ^ (x >>> 15), 0x846ca68b);
  return (x ^ (x >>> 16)) >>> 0;
}

/** Returns the colours that a person wears, as does throng render: CHOICE_BITS per slot, the shirt lowest. */
export function clothesOf(id: number): number {
  const random = scatter(id + 1);
  return WARDROBE.reduce((all, colors, slot) => all | ((random >>> (4 * slot)) % colors.length << (CHOICE_BITS * slot)), 0);
}

export const MARK_COLORS = MARKS.map((mark) => new Color(mark.color));

/** Returns the clothes of a part; all parts of a robot get the colour of shirts. */
export function slotOf(partName: string): number {
  if (/head/i.test(partName)) return 2;
  if (/hand/i.test(partName)) return 2;
  if (/foot/i.test(partName)) return 4;
  if (/leg|pelvis/i.test(partName)) return 1;
  return 0;
}
