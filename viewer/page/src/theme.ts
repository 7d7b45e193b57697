// Colours. Contacts have Okabe and Ito's palette, safe for colour-blind readers; the rest is muted.
import {Color} from 'three';

export type ThemeName = 'light' | 'dark';

/** By mark: 0 for sphere candidates, else 1 + the level at which a pair was decided. */
export const MARKS = [
  {color: '#56b4e9', name: 'Sphere candidate', about: "the person's sphere overlaps another's"},
  {color: '#0072b2', name: 'Spheres only', about: 'a pair of people, not refined within the budget'},
  {color: '#009e73', name: 'Boxes only', about: 'a pair of parts, not refined within the budget'},
  {color: '#e69f00', name: 'or-DOP pair', about: "the parts' volumes overlap"},
  {color: '#d55e00', name: 'Exact contact', about: 'triangles of the parts intersect'},
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

const linear = (names: string[]): Color[] => names.map((name) => new Color(name));

/** Muted clothes, because touching parts have to stand out. */
export const CLOTHES = {
  uShirts: linear(['#6d7f94', '#8c9aa8', '#a9b4bf', '#5d6b80', '#7d8f8a', '#94a09a', '#7a7f92', '#c3c9cf']),
  uTrousers: linear(['#39424f', '#4a5261', '#2f3642', '#57534f', '#5e6672']),
  uSkins: linear(['#c99b7d', '#a8775a', '#e0b79a', '#7c5540', '#d3a88a']),
  uHairs: linear(['#3a302b', '#231f20', '#5a4638', '#77695c']),
  uShoes: linear(['#2b2d33', '#3b3632', '#50545c']),
};

export const MARK_COLORS = MARKS.map((mark) => new Color(mark.color));

/** Returns the clothes of a part; all parts of a robot get the colour of shirts. */
export function slotOf(partName: string): number {
  if (/head/i.test(partName)) return 2;
  if (/hand/i.test(partName)) return 2;
  if (/foot/i.test(partName)) return 4;
  if (/leg|pelvis/i.test(partName)) return 1;
  return 0;
}
