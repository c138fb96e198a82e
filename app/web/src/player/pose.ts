/** The pose of a body at a time, as the player shows it. */
import type { SkeletonMotion } from "$/motion/motion";
import { mirrored } from "$/motion/skeleton";

export interface PoseOptions {
  /** The hips stay over one place. */
  readonly inPlace: boolean;
  /** Left and right change places. */
  readonly mirror: boolean;
}

export interface Rig {
  readonly motion: SkeletonMotion;
  /** Index of the joint that stands for the body: the hips, or the first root. */
  readonly root: number;
  /** For each joint the one on the other side. */
  readonly mirrors: readonly number[];
}

/** hips: the name of the hips' joint, if it is known. */
export function rigOf(motion: SkeletonMotion, hips: string | undefined): Rig {
  const named = hips === undefined ? -1 : motion.names.indexOf(hips);
  const mirrors = motion.names.map((name, joint) => {
    const other = motion.names.indexOf(mirrored(name));
    return other < 0 ? joint : other;
  });
  return { motion, root: named >= 0 ? named : Math.max(0, motion.parents.indexOf(-1)), mirrors };
}

export function length(motion: SkeletonMotion): number {
  return Math.max(0, motion.frames - 1) / motion.frameRate;
}

/** Writes (joints, 3) meters into `out`: between two frames as far as the time is between them. */
export function poseAt(rig: Rig, seconds: number, options: PoseOptions, out: Float32Array): void {
  const { motion, root, mirrors } = rig;
  const { positions, joints, frames } = motion;
  const exact = Math.min(Math.max(0, seconds * motion.frameRate), frames - 1);
  const frame = Math.floor(exact);
  const share = exact - frame;
  const [from, to] = [frame * joints * 3, Math.min(frame + 1, frames - 1) * joints * 3];
  const value = (joint: number, axis: number): number => {
    const at = joint * 3 + axis;
    const before = positions[from + at] ?? 0;
    return before + share * ((positions[to + at] ?? 0) - before);
  };
  const startX = positions[root * 3] ?? 0;
  const startZ = positions[root * 3 + 2] ?? 0;
  const goneX = options.inPlace ? value(root, 0) - startX : 0;
  const goneZ = options.inPlace ? value(root, 2) - startZ : 0;
  for (let joint = 0; joint < joints; joint += 1) {
    const source = options.mirror ? (mirrors[joint] ?? joint) : joint;
    const x = value(source, 0) - goneX;
    out[joint * 3] = options.mirror ? 2 * startX - x : x;
    out[joint * 3 + 1] = value(source, 1);
    out[joint * 3 + 2] = value(source, 2) - goneZ;
  }
}
