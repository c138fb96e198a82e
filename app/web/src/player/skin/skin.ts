/**
 * A body with a skin in the scene: a mesh that the landmarks of each pose move.
 *
 * Its points are moved here, not by three.js's SkinnedMesh: where WebGL is drawn by software, that
 * reads 16 texels for each point of each picture, which costs more than twice the time.
 */
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DynamicDrawUsage,
  Float32BufferAttribute,
  Group,
  MathUtils,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
} from "three";
import type { Side } from "$/motion/skeleton";
import { poseAt, type PoseOptions, type Rig } from "../pose";
import { emptyLandmarks, landmarksOf, type Anatomy } from "./anatomy";
import { Frames, PARTS } from "./frames";
import { sharesOf, type BodyMesh } from "./mesh";
import { skinned } from "./skinned";

/** Where limb and trunk meet, the color changes within this share of the weights. */
const SEAM = [0.35, 0.65] as const;
/** How much of the trunk's color is in the skin of a limb. */
const TINT = 0.85;
/** How much milder the trunk's color is than that of its bones. */
const MILD = 0.45;

export class Skin {
  readonly group = new Group();
  readonly #geometry = new BufferGeometry();
  readonly #material: MeshLambertMaterial;
  readonly #matrices = PARTS.map(() => new Matrix4());
  readonly #frames: Frames;
  readonly #landmarks = emptyLandmarks();
  readonly #pose: Float32Array;

  constructor(
    readonly rig: Rig,
    private readonly anatomy: Anatomy,
    private readonly made: BodyMesh,
    opacity: number,
  ) {
    const isGhost = opacity < 1;
    this.#pose = new Float32Array(rig.motion.joints * 3);
    this.#frames = new Frames(made.rest.at);
    this.#material = new MeshLambertMaterial({
      vertexColors: true,
      transparent: isGhost,
      opacity,
      depthWrite: !isGhost,
    });
    this.#geometry.setIndex(new BufferAttribute(made.triangles, 1));
    for (const name of ["position", "normal"] as const) {
      const moved = new BufferAttribute(new Float32Array(made.points.length), 3);
      this.#geometry.setAttribute(name, moved.setUsage(DynamicDrawUsage));
    }
    const mesh = new Mesh(this.#geometry, this.#material);
    mesh.frustumCulled = false;
    this.group.add(mesh);
  }

  color(colors: Readonly<Record<Side, string>>): void {
    const trunk = milder(new Color(colors.trunk));
    const shares = { left: sharesOf(this.made, "left"), right: sharesOf(this.made, "right") };
    const values = new Float32Array(shares.left.length * 3);
    const [color, limb] = [new Color(), new Color()];
    for (let vertex = 0; vertex < shares.left.length; vertex += 1) {
      color.copy(trunk);
      for (const side of ["left", "right"] as const) {
        const share = (shares[side][vertex] ?? 0) - SEAM[0];
        const within = Math.min(1, Math.max(0, share / (SEAM[1] - SEAM[0])));
        color.lerp(limb.set(colors[side]), within * TINT);
      }
      color.toArray(values, vertex * 3);
    }
    this.#geometry.setAttribute("color", new Float32BufferAttribute(values, 3));
  }

  show(seconds: number, options: PoseOptions): Float32Array {
    poseAt(this.rig, seconds, options, this.#pose);
    this.#frames.show(landmarksOf(this.anatomy, this.#pose, this.#landmarks), this.#matrices);
    const [points, normals] = ["position", "normal"].map((name) =>
      this.#geometry.getAttribute(name),
    );
    if (points && normals) {
      skinned(
        this.made,
        this.#matrices,
        points.array as Float32Array,
        normals.array as Float32Array,
      );
      points.needsUpdate = normals.needsUpdate = true;
    }
    return this.#pose;
  }

  dispose(): void {
    this.#geometry.dispose();
    this.#material.dispose();
  }
}

/** Nearer to a medium lightness, on which light and shadow show the form. */
function milder(color: Color): Color {
  const { h, s, l } = color.getHSL({ h: 0, s: 0, l: 0 });
  return color.setHSL(h, s, MathUtils.lerp(l, 0.5, MILD));
}
