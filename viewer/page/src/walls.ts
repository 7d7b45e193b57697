// Walls draws the obstacles of a run. Those that hide a selected person are drawn as glass.
import {DoubleSide, Group, Mesh, Vector3, type Color, type RawShaderMaterial} from 'three';
import {boxOf, solidGeometry} from './bodies.ts';
import {oncePerPixel} from './crowd.ts';
import {entersBox} from './picking.ts';
import type {Obstacle, Run} from './protocol.ts';
import {FLAT_SHADOW_VERTEX, SHADOW_FRAGMENT, SOLID_FRAGMENT, SOLID_VERTEX, shaderMaterial, type Uniforms} from './shaders.ts';

const GLASS = 0.18;
const UP = new Vector3(0, 0, 1);
/** Drawn after the shadows, before spheres. */
const GLASS_ORDER = 2;
/** A wall that a line of sight reaches only at its end is behind the person. */
const BEFORE = 0.99;

export interface WallColors {
  solid: {value: Color};
  chosen: {value: Color};
}

interface Wall {
  mesh: Mesh;
  obstacle: Obstacle;
  centre: Vector3;
  half: Vector3;
}

export class Walls {
  readonly group = new Group();
  private readonly shadows = new Group();
  private readonly walls: Wall[] = [];
  private readonly solid: RawShaderMaterial;
  private readonly glass: RawShaderMaterial;
  private readonly chosen: RawShaderMaterial;
  private readonly shadow: RawShaderMaterial;
  private readonly origin = new Vector3();
  private readonly direction = new Vector3();

  constructor(
    private readonly run: Run,
    shared: Uniforms,
    colors: WallColors,
  ) {
    const material = (uColor: {value: Color}, alpha: number): RawShaderMaterial =>
      shaderMaterial(SOLID_VERTEX, SOLID_FRAGMENT, {...shared, uColor, uAlpha: {value: alpha}});
    this.solid = material(colors.solid, 1);
    this.chosen = material(colors.chosen, 1);
    this.glass = material(colors.solid, GLASS);
    this.glass.transparent = true;
    this.glass.depthWrite = false;
    this.shadow = oncePerPixel(shaderMaterial(FLAT_SHADOW_VERTEX, SHADOW_FRAGMENT, shared));
    this.shadow.transparent = true;
    this.shadow.depthWrite = false;
    this.shadow.side = DoubleSide;
    this.group.add(this.shadows);
    for (const obstacle of run.obstacles) this.add(obstacle);
  }

  private add(obstacle: Obstacle): void {
    const geometry = solidGeometry(obstacle.mesh);
    const [mesh, shadow] = [this.solid, this.shadow].map((material) => {
      const part = new Mesh(geometry, material);
      part.position.set(...obstacle.centre_m);
      part.rotation.z = obstacle.heading_rad;
      return part;
    });
    this.group.add(mesh);
    this.shadows.add(shadow);
    shadow.renderOrder = 1;
    const box = boxOf(obstacle.mesh);
    this.walls.push({mesh, obstacle, centre: new Vector3(...box.centre_m), half: new Vector3(...box.half_m)});
  }

  showShadows(visible: boolean): void {
    this.shadows.visible = visible;
  }

  /** Turns walls between the eye and the points to glass, except those among the selected bodies. */
  arrange(eye: Vector3, points: Vector3[], selected: readonly number[]): void {
    this.walls.forEach((wall, index) => {
      const isChosen = selected.includes(this.run.avatars + index);
      const isGlass = !isChosen && points.some((point) => this.hides(wall, eye, point));
      wall.mesh.material = isChosen ? this.chosen : isGlass ? this.glass : this.solid;
      wall.mesh.renderOrder = isGlass ? GLASS_ORDER : 0;
    });
  }

  private hides(wall: Wall, eye: Vector3, point: Vector3): boolean {
    const {centre_m, heading_rad} = wall.obstacle;
    this.direction.subVectors(point, eye).applyAxisAngle(UP, -heading_rad);
    this.origin.set(...centre_m).sub(eye).negate().applyAxisAngle(UP, -heading_rad).sub(wall.centre);
    return entersBox(this.origin, this.direction, wall.half) < BEFORE;
  }

  dispose(): void {
    for (const {mesh} of this.walls) mesh.geometry.dispose();
    for (const material of [this.solid, this.glass, this.chosen, this.shadow]) material.dispose();
  }
}
