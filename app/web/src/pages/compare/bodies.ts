/** Bodies as they are compared: turned the same way, or in the body frame. */
import type { SkeletonMotion } from "$/motion/motion";

type Roles = Readonly<Record<string, string>>;

/** The pairs of joints that tell where a body looks, as `app/motion/frame/body_frame.py` has. */
const PAIRS = [
  ["left_shoulder", "right_shoulder"],
  ["left_upper_leg", "right_upper_leg"],
  ["left_knee", "right_knee"],
] as const;
/** The least level share of the line from right to left: with less, it tells no heading. */
const MIN_LEVEL = 0.2;

/** The motion turned as a whole, so that its body looks ahead (along Z) at a time. */
export function facingAhead(motion: SkeletonMotion, roles: Roles, seconds: number): SkeletonMotion {
  const frame = Math.min(Math.max(0, Math.round(seconds * motion.frameRate)), motion.frames - 1);
  const angle = -(headings(motion, roles)[frame] ?? 0);
  const positions = new Float32Array(motion.positions.length);
  for (let at = 0; at < positions.length; at += 3) turn(motion.positions, at, angle, positions);
  return { ...motion, positions };
}

/**
 * The motion in the body frame: in every frame the hips are at one place, `height` meters over the
 * floor, and the body looks ahead. scale: how much larger it becomes.
 */
export function inBodyFrame(
  motion: SkeletonMotion,
  roles: Roles,
  scale: number,
  height: number,
): SkeletonMotion {
  const angles = headings(motion, roles);
  const hips = Math.max(0, motion.names.indexOf(roles.hips ?? ""));
  const size = motion.joints * 3;
  const positions = new Float32Array(motion.positions.length);
  for (let frame = 0; frame < motion.frames; frame += 1) {
    const first = frame * size;
    const [x = 0, y = 0, z = 0] = motion.positions.subarray(first + hips * 3);
    for (let at = first; at < first + size; at += 3) {
      positions[at] = scale * ((motion.positions[at] ?? 0) - x);
      positions[at + 1] = scale * ((motion.positions[at + 1] ?? 0) - y) + height;
      positions[at + 2] = scale * ((motion.positions[at + 2] ?? 0) - z);
      turn(positions, at, -(angles[frame] ?? 0), positions);
    }
  }
  return { ...motion, positions };
}

/** (frames,) radians: the turn about Y from Z to where the body looks; upright, the one before. */
function headings(motion: SkeletonMotion, roles: Roles): Float32Array {
  const angles = new Float32Array(motion.frames);
  const [left, right] = sides(motion, roles) ?? [];
  if (left === undefined || right === undefined) return angles;
  let last: number | null = null;
  for (let frame = 0; frame < motion.frames; frame += 1) {
    const angle: number | null = headingOf(motion, frame, left, right) ?? last;
    if (angle !== null && last === null) angles.fill(angle, 0, frame);
    last = angle;
    angles[frame] = angle ?? 0;
  }
  return angles;
}

function sides(motion: SkeletonMotion, roles: Roles): readonly [number, number] | undefined {
  return PAIRS.map(
    ([left, right]) =>
      [motion.names.indexOf(roles[left] ?? ""), motion.names.indexOf(roles[right] ?? "")] as const,
  ).find(
    ([left, right]) =>
      left >= 0 &&
      right >= 0 &&
      Array.from({ length: motion.frames }, (_, frame) => frame).some(
        (frame) => headingOf(motion, frame, left, right) !== null,
      ),
  );
}

function headingOf(
  { positions, joints }: SkeletonMotion,
  frame: number,
  left: number,
  right: number,
): number | null {
  const line = [0, 1, 2].map((axis) => {
    const at = frame * joints * 3 + axis;
    return (positions[at + left * 3] ?? 0) - (positions[at + right * 3] ?? 0);
  });
  const [x = 0, y = 0, z = 0] = line;
  const across = Math.hypot(x, z);
  return across > MIN_LEVEL * Math.hypot(x, y, z) ? Math.atan2(-z, x) : null;
}

/** Turn the point at `at` about Y, from Z toward X. */
function turn(points: Float32Array, at: number, angle: number, out: Float32Array): void {
  const [x = 0, y = 0, z = 0] = points.subarray(at);
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  out[at] = cos * x + sin * z;
  out[at + 1] = y;
  out[at + 2] = cos * z - sin * x;
}

/** Mean height of the hips over the floor, meters. */
export function hipHeight(motion: SkeletonMotion, roles: Roles): number {
  const hips = Math.max(0, motion.names.indexOf(roles.hips ?? ""));
  let total = 0;
  for (let frame = 0; frame < motion.frames; frame += 1) {
    total += motion.positions[(frame * motion.joints + hips) * 3 + 1] ?? 0;
  }
  return total / Math.max(1, motion.frames);
}

/**
 * For each joint the place of its role in `joints`; of a joint without a role (fingers, spine)
 * that of the nearest joint above it that has one; -1 where there is none.
 */
export function rolesOfJoints(
  motion: SkeletonMotion,
  roles: Roles,
  joints: readonly string[],
): readonly number[] {
  const own = new Map(
    joints.flatMap((role, place) => {
      const name = roles[role];
      return name === undefined ? [] : [[name, place] as const];
    }),
  );
  return motion.names.map((_, joint) => {
    for (let at = joint; at >= 0; at = motion.parents[at] ?? -1) {
      const place = own.get(motion.names[at] ?? "");
      if (place !== undefined) return place;
    }
    return -1;
  });
}
