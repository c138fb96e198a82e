/** One body in the scene: bones, joints and head, in the colors of their sides. */
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  CylinderGeometry,
  DynamicDrawUsage,
  Group,
  InstancedMesh,
  Line,
  LineBasicMaterial,
  Matrix4,
  MeshLambertMaterial,
  Quaternion,
  SphereGeometry,
  Vector3,
} from "three";
import { sideOf, type Side } from "$/motion/skeleton";
import { poseAt, type PoseOptions, type Rig } from "./pose";
import { anatomyOf, type Anatomy } from "./skin/anatomy";
import { Eyes } from "./skin/eyes";
import type { Frame } from "./skin/frames";
import { FINE, meshOf, type BodyMesh } from "./skin/mesh";
import { restOf } from "./skin/rest";
import { Skin } from "./skin/skin";

export type BodyColors = Readonly<Record<Side, string>>;

/** Meters. */
const BONE = 0.022;
const JOINT = 0.026;
const HEAD = 0.1;
/** Seconds before and after at which a ghost stands, and how much of it is seen. */
const GHOSTS = [0.2, 0.4, 0.6].flatMap((apart, place) =>
  [-apart, apart].map((seconds) => ({ seconds, opacity: 0.3 - 0.08 * place })),
);
const TRAIL_SECONDS = 1.5;
const TRAIL_POINTS = 60;
const UP = new Vector3(0, 1, 0);

const cylinder = new CylinderGeometry(0.62, 1, 1, 8).translate(0, 0.5, 0);
const sphere = new SphereGeometry(1, 12, 8);

/** What shows one pose. */
interface Shape {
  readonly group: Group;
  color(colors: BodyColors, tint?: readonly number[] | null): void;
  /** Gives the pose that is shown. */
  show(seconds: number, options: PoseOptions): Float32Array;
  dispose(): void;
}

/** The bones and joints of one pose, as two meshes. */
class Figure implements Shape {
  readonly group = new Group();
  readonly #bones: InstancedMesh;
  readonly #joints: InstancedMesh;
  readonly #material: MeshLambertMaterial;
  readonly #pose: Float32Array;

  constructor(
    readonly rig: Rig,
    readonly head: number,
    opacity: number,
  ) {
    const { joints } = rig.motion;
    this.#pose = new Float32Array(joints * 3);
    const isGhost = opacity < 1;
    this.#material = new MeshLambertMaterial({
      transparent: isGhost,
      opacity,
      depthWrite: !isGhost,
    });
    this.#bones = new InstancedMesh(cylinder, this.#material, joints);
    this.#joints = new InstancedMesh(sphere, this.#material, joints);
    for (const mesh of [this.#bones, this.#joints]) {
      mesh.instanceMatrix.setUsage(DynamicDrawUsage);
      mesh.frustumCulled = false;
      this.group.add(mesh);
    }
  }

  /** tint: a color of each joint, 0xrrggbb, instead of that of its side. */
  color(colors: BodyColors, tint?: readonly number[] | null): void {
    const color = new Color();
    this.rig.motion.names.forEach((name, joint) => {
      color.set(tint?.[joint] ?? colors[sideOf(name)]);
      this.#bones.setColorAt(joint, color);
      this.#joints.setColorAt(joint, color);
    });
    for (const mesh of [this.#bones, this.#joints]) {
      if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
    }
  }

  show(seconds: number, options: PoseOptions): Float32Array {
    poseAt(this.rig, seconds, options, this.#pose);
    const { parents } = this.rig.motion;
    const [matrix, turn, size] = [new Matrix4(), new Quaternion(), new Vector3()];
    const [joint, parent, along] = [new Vector3(), new Vector3(), new Vector3()];
    parents.forEach((above, index) => {
      joint.fromArray(this.#pose, index * 3);
      const radius = index === this.head ? HEAD : JOINT;
      this.#joints.setMatrixAt(index, matrix.makeScale(radius, radius, radius).setPosition(joint));
      along.set(0, 0, 0);
      if (above >= 0) along.subVectors(joint, parent.fromArray(this.#pose, above * 3));
      const reach = along.length();
      if (reach > 0) turn.setFromUnitVectors(UP, along.divideScalar(reach));
      size.set(reach > 0 ? BONE : 0, reach, reach > 0 ? BONE : 0);
      this.#bones.setMatrixAt(index, matrix.compose(parent, turn, size));
    });
    this.#bones.instanceMatrix.needsUpdate = true;
    this.#joints.instanceMatrix.needsUpdate = true;
    return this.#pose;
  }

  dispose(): void {
    this.#bones.dispose();
    this.#joints.dispose();
    this.#material.dispose();
  }
}

export interface BodyOptions extends PoseOptions {
  /** A body with a skin, where the skeleton is that of a person; else bones. */
  readonly skin: boolean;
  readonly ghosts: boolean;
  readonly trails: boolean;
}

export interface BodySource {
  readonly rig: Rig;
  /** Index of the head's joint, -1 where there is none. */
  readonly head: number;
  /** Indices of the joints that leave trails. */
  readonly ends: readonly number[];
  /** Names of joints by role, as far as they are known. */
  readonly roles: Readonly<Record<string, string>>;
}

export class Body {
  readonly group = new Group();
  /** (joints, 3) of the pose that is shown, in the body's own coordinates. */
  pose: Float32Array = new Float32Array();
  /** Null where it is not the body of a person: then it is shown as bones only. */
  readonly #anatomy: Anatomy | null;
  #shape: Shape;
  #isSkin = false;
  /** Made once, when the body is first seen with its skin. */
  #mesh: BodyMesh | null = null;
  #eyes: Eyes | null = null;
  #ghosts: readonly Shape[] = [];
  #trails: readonly { joint: number; line: Line }[] = [];
  #colors: BodyColors;
  #isTinted = false;

  constructor(
    readonly source: BodySource,
    colors: BodyColors,
    /** How fine its skin is: FINE or COARSE. */
    private readonly cells = FINE,
  ) {
    const { rig, roles } = source;
    const { positions } = rig.motion;
    this.#colors = colors;
    this.#anatomy = anatomyOf(rig.motion, roles);
    this.#shape = this.#newShape(1);
    const [x = 0, , z = 0] = positions.subarray(rig.root * 3);
    this.group.position.set(-x, 0, -z);
  }

  get isPerson(): boolean {
    return this.#anatomy !== null;
  }

  color(colors: BodyColors): void {
    this.#colors = colors;
    for (const shape of [this.#shape, ...this.#ghosts]) shape.color(colors);
    this.#clearTrails();
  }

  /** tint: a color of each joint. A skin has no joints, so such a body is seen as its bones. */
  show(seconds: number, options: BodyOptions, tint: readonly number[] | null = null): void {
    this.#wear(options.skin && tint === null && this.#anatomy !== null);
    if (tint || this.#isTinted) this.#shape.color(this.#colors, tint);
    this.#isTinted = tint !== null;
    this.pose = this.#shape.show(seconds, options);
    this.#showGhosts(seconds, options);
    this.#showTrails(seconds, options);
  }

  /** What the person sees in the pose that is shown, in the body's own coordinates; null where it
      is not known which joints are those of a person. */
  get eyes(): Frame | null {
    if (!this.#anatomy) return null;
    this.#eyes ??= new Eyes(this.#anatomy, restOf(this.source.rig.motion, this.#anatomy));
    return this.#eyes.in(this.pose);
  }

  dispose(): void {
    this.#remove([this.#shape, ...this.#ghosts]);
    this.#clearTrails();
  }

  #wear(isSkin: boolean): void {
    if (isSkin === this.#isSkin) return;
    this.#isSkin = isSkin;
    this.#remove([this.#shape, ...this.#ghosts]);
    this.#ghosts = [];
    this.#shape = this.#newShape(1);
  }

  #newShape(opacity: number): Shape {
    const { rig, head } = this.source;
    const anatomy = this.#isSkin ? this.#anatomy : null;
    if (anatomy) this.#mesh ??= meshOf(rig.motion, anatomy, this.cells);
    const shape =
      anatomy && this.#mesh
        ? new Skin(rig, anatomy, this.#mesh, opacity)
        : new Figure(rig, head, opacity);
    shape.color(this.#colors);
    this.group.add(shape.group);
    return shape;
  }

  #remove(shapes: readonly Shape[]): void {
    for (const shape of shapes) {
      shape.group.removeFromParent();
      shape.dispose();
    }
  }

  #showGhosts(seconds: number, options: BodyOptions): void {
    if (options.ghosts && this.#ghosts.length === 0) {
      this.#ghosts = GHOSTS.map(({ opacity }) => this.#newShape(opacity));
    }
    this.#ghosts.forEach((ghost, place) => {
      const at = seconds + (GHOSTS[place]?.seconds ?? 0);
      const { frames, frameRate } = this.source.rig.motion;
      ghost.group.visible = options.ghosts && at >= 0 && at * frameRate <= frames - 1;
      if (ghost.group.visible) ghost.show(at, options);
    });
  }

  #showTrails(seconds: number, options: BodyOptions): void {
    if (!options.trails) return this.#clearTrails();
    if (this.#trails.length === 0) this.#makeTrails();
    const pose = new Float32Array(this.source.rig.motion.joints * 3);
    for (let point = 0; point < TRAIL_POINTS; point += 1) {
      const ago = TRAIL_SECONDS * (1 - point / (TRAIL_POINTS - 1));
      poseAt(this.source.rig, Math.max(0, seconds - ago), options, pose);
      for (const { joint, line } of this.#trails) {
        const [x = 0, y = 0, z = 0] = pose.subarray(joint * 3);
        line.geometry.getAttribute("position").setXYZ(point, x, y, z);
      }
    }
    for (const { line } of this.#trails) {
      line.geometry.getAttribute("position").needsUpdate = true;
    }
  }

  #makeTrails(): void {
    this.#trails = this.source.ends.map((joint) => {
      const name = this.source.rig.motion.names[joint] ?? "";
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(new Float32Array(TRAIL_POINTS * 3), 3));
      const material = new LineBasicMaterial({
        color: this.#colors[sideOf(name)],
        transparent: true,
        opacity: 0.7,
      });
      const line = new Line(geometry, material);
      line.frustumCulled = false;
      this.group.add(line);
      return { joint, line };
    });
  }

  #clearTrails(): void {
    for (const { line } of this.#trails) {
      line.removeFromParent();
      line.geometry.dispose();
      (line.material as LineBasicMaterial).dispose();
    }
    this.#trails = [];
  }
}
