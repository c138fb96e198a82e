/**
 * The flat view of a body: the horizontal direction in which its joints move most relative to the
 * hips, so that a walk is seen from the side. The same as in the server's pictures
 * (`app/services/figures`), whose stills these views replace when they move.
 */
import type { Motion } from "./motion";
import { HIPS } from "./roles";

const EXTENT_WEIGHT = 0.05;
/** Meters; a body that moves less far stays in place. */
const STAYS = 0.05;
/** A body that needs more room than this many of its heights is followed. */
const FOLLOW_OVER = 1.6;

export interface View {
  /** Horizontal unit vector (x, z): the picture's x axis. */
  readonly x: number;
  readonly z: number;
  /** Meters: the lowest and highest points, and the leftmost and rightmost along the axis. */
  readonly floor: number;
  readonly top: number;
  readonly left: number;
  readonly right: number;
  /** Whether the view goes with the hips; then left and right are relative to them. */
  readonly follows: boolean;
}

export function viewOf(motion: Motion): View {
  const [x, z] = direction(motion);
  const [floor, top] = range(motion, (at) => motion.positions[at + 1] ?? 0);
  const across = (at: number): number => along(motion, at, x, z);
  const around = (at: number, hips: number): number => across(at) - across(hips);
  const [left, right] = range(motion, across);
  const follows = right - left > FOLLOW_OVER * (top - floor);
  const [nearLeft, nearRight] = follows ? range(motion, around) : [left, right];
  return { x, z, floor, top, left: nearLeft, right: nearRight, follows };
}

export function along(motion: Motion, at: number, x: number, z: number): number {
  return (motion.positions[at] ?? 0) * x + (motion.positions[at + 2] ?? 0) * z;
}

/** Where a joint's x stands among the positions. */
export function offset(motion: Motion, frame: number, joint: number): number {
  return (frame * motion.joints + joint) * 3;
}

function range(motion: Motion, value: (at: number, hips: number) => number): [number, number] {
  let [least, most] = [Infinity, -Infinity];
  for (let frame = 0; frame < motion.frames; frame += 1) {
    const hips = offset(motion, frame, HIPS);
    for (let joint = 0; joint < motion.joints; joint += 1) {
      const found = value(offset(motion, frame, joint), hips);
      least = Math.min(least, found);
      most = Math.max(most, found);
    }
  }
  return [least, most];
}

function direction(motion: Motion): [number, number] {
  const [xx, xz, zz] = spread(motion);
  const angle = 0.5 * Math.atan2(2 * xz, xx - zz);
  const [x, z] = [Math.cos(angle), Math.sin(angle)];
  const [first, last] = [offset(motion, 0, HIPS), offset(motion, motion.frames - 1, HIPS)];
  const gone = along(motion, last, x, z) - along(motion, first, x, z);
  const sign = Math.abs(gone) < STAYS ? (Math.abs(x) >= Math.abs(z) ? x : z) : gone;
  return sign >= 0 ? [x, z] : [-x, -z];
}

/** Second moments of the joints around the hips: of their movement, and a little of their extent. */
function spread(motion: Motion): [number, number, number] {
  let [xx, xz, zz] = [0, 0, 0];
  for (let joint = 0; joint < motion.joints; joint += 1) {
    let [sumX, sumZ, sumXX, sumXZ, sumZZ] = [0, 0, 0, 0, 0];
    for (let frame = 0; frame < motion.frames; frame += 1) {
      const [at, hips] = [offset(motion, frame, joint), offset(motion, frame, HIPS)];
      const x = (motion.positions[at] ?? 0) - (motion.positions[hips] ?? 0);
      const z = (motion.positions[at + 2] ?? 0) - (motion.positions[hips + 2] ?? 0);
      sumX += x;
      sumZ += z;
      sumXX += x * x;
      sumXZ += x * z;
      sumZZ += z * z;
    }
    xx += sumXX * (1 + EXTENT_WEIGHT) - (sumX * sumX) / motion.frames;
    xz += sumXZ * (1 + EXTENT_WEIGHT) - (sumX * sumZ) / motion.frames;
    zz += sumZZ * (1 + EXTENT_WEIGHT) - (sumZ * sumZ) / motion.frames;
  }
  return [xx, xz, zz];
}
