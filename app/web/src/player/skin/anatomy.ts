/** Which joints of a skeleton are the landmarks of a human body, and where they are in a pose. */
import { Vector3 } from "three";
import type { SkeletonMotion } from "$/motion/motion";

export const SIDES = ["left", "right"] as const;
export type BodySide = (typeof SIDES)[number];

const LIMB_POINTS = [
  "shoulder",
  "elbow",
  "hand",
  "fingers",
  "hip",
  "knee",
  "foot",
  "toes",
] as const;
type LimbPoint = (typeof LIMB_POINTS)[number];
export type Landmark = "hips" | "waist" | "neck" | "head" | `${BodySide}_${LimbPoint}`;
/** Meters. */
export type Landmarks = Record<Landmark, Vector3>;

/** Lengths of a person's legs and arms, as shares of the trunk and of the legs (wide limits). */
const LEGS_PER_TRUNK = [1, 2.6] as const;
const ARMS_PER_LEGS = [0.4, 1.1] as const;
/** The distance of the hips' joints as a share of the shoulders', where no joint shows them. */
const HIPS_PER_SHOULDERS = 0.52;
/** Lengths of hands and feet as shares of the forearm and of the shin, likewise. */
const HAND_PER_FOREARM = 0.35;
const FOOT_PER_SHIN = 0.35;

type Joints = Readonly<Record<Landmark, readonly number[]>>;

export interface Anatomy {
  /** For each landmark the joints whose middle it is; none where it is estimated. */
  readonly joints: Joints;
}

/** The landmarks of a skeleton by its roles; null where it is not the body of a person. */
export function anatomyOf(
  motion: SkeletonMotion,
  roles: Readonly<Record<string, string>>,
): Anatomy | null {
  const role = (name: string): number[] => {
    const joint = motion.names.indexOf(roles[name] ?? "");
    return joint < 0 ? [] : [joint];
  };
  const joints = {
    hips: role("hips"),
    neck: role("neck"),
    head: role("head"),
  } as Record<Landmark, number[]>;
  joints.waist = waistOf(motion, joints.hips[0], joints.neck[0]);
  for (const side of SIDES) {
    for (const point of LIMB_POINTS) joints[`${side}_${point}`] = role(`${side}_${point}`);
    joints[`${side}_hip`] = role(`${side}_upper_leg`);
    joints[`${side}_fingers`] = fingersOf(motion, joints[`${side}_hand`][0]);
  }
  const anatomy = { joints: { ...joints, ...trunkEnds(motion, joints) } };
  return needed().every((name) => joints[name].length > 0) && isPerson(motion, anatomy)
    ? anatomy
    : null;
}

/**
 * The ends of the trunk. Files have the joint of the hips at the pelvis or well above it, and that
 * of the neck at its base or low in the chest: then the limbs' own joints show where the trunk ends.
 */
function trunkEnds(
  { positions }: SkeletonMotion,
  { hips, neck, left_hip, right_hip, left_shoulder, right_shoulder }: Joints,
): Pick<Joints, "hips" | "neck"> {
  const height = (joints: readonly number[]): number =>
    joints.reduce((sum, joint) => sum + (positions[joint * 3 + 1] ?? 0), 0) / joints.length;
  const shoulders = [...left_shoulder, ...right_shoulder];
  const isUpright = height(shoulders) > height(hips);
  const isLow = height(neck) < height(shoulders);
  return {
    hips: left_hip.length > 0 && right_hip.length > 0 ? [...left_hip, ...right_hip] : hips,
    neck: isUpright && isLow ? shoulders : neck,
  };
}

function needed(): readonly Landmark[] {
  const limbs = SIDES.flatMap((side) =>
    (["shoulder", "elbow", "hand", "knee", "foot"] as const).map(
      (point): Landmark => `${side}_${point}`,
    ),
  );
  return ["hips", "neck", "head", ...limbs];
}

/** The joint in the middle of the spine. */
function waistOf({ parents }: SkeletonMotion, hips = -1, neck = -1): number[] {
  const between: number[] = [];
  for (let joint = parents[neck] ?? -1; joint !== hips; joint = parents[joint] ?? -1) {
    if (joint < 0) return [];
    between.push(joint);
  }
  const middle = between[Math.floor((between.length - 1) / 2)];
  return middle === undefined ? [] : [middle];
}

/** The joints next to the wrist, without the thumb. */
function fingersOf({ names, parents }: SkeletonMotion, hand = -2): number[] {
  return names.flatMap((name, joint) =>
    parents[joint] === hand && !/thumb/i.test(name) ? [joint] : [],
  );
}

/** Whether the limbs are as long as those of a person, in the first frame. */
function isPerson(motion: SkeletonMotion, anatomy: Anatomy): boolean {
  const at = landmarksOf(anatomy, motion.positions, emptyLandmarks());
  const trunk = at.hips.distanceTo(at.neck);
  const lengths = (...points: LimbPoint[]): number =>
    Math.max(
      ...SIDES.map((side) =>
        points
          .slice(1)
          .map((point, place) =>
            at[`${side}_${point}`].distanceTo(at[`${side}_${points[place] ?? point}`]),
          )
          .reduce((sum, length) => sum + length, 0),
      ),
    );
  const legs = lengths("hip", "knee", "foot");
  return (
    isWithin(legs / trunk, LEGS_PER_TRUNK) &&
    isWithin(lengths("shoulder", "elbow", "hand") / legs, ARMS_PER_LEGS)
  );
}

function isWithin(value: number, [least, most]: readonly [number, number]): boolean {
  return value >= least && value <= most;
}

export function emptyLandmarks(): Landmarks {
  const names: readonly Landmark[] = [
    ...(["hips", "waist", "neck", "head"] as const),
    ...SIDES.flatMap((side) => LIMB_POINTS.map((point): Landmark => `${side}_${point}`)),
  ];
  return Object.fromEntries(names.map((name) => [name, new Vector3()])) as Landmarks;
}

/** The landmarks in a pose, (joints, 3) meters, written into `out`; those without a joint are
    estimated from their neighbors. */
export function landmarksOf({ joints }: Anatomy, pose: Float32Array, out: Landmarks): Landmarks {
  const point = new Vector3();
  for (const name of Object.keys(out) as Landmark[]) {
    const found = out[name].set(0, 0, 0);
    for (const joint of joints[name]) found.add(point.fromArray(pose, joint * 3));
    if (joints[name].length > 1) found.divideScalar(joints[name].length);
  }
  if (joints.waist.length === 0) out.waist.lerpVectors(out.hips, out.neck, 0.45);
  const across = new Vector3().subVectors(out.left_shoulder, out.right_shoulder);
  for (const [side, sign] of [
    ["left", 1],
    ["right", -1],
  ] as const) {
    const at = (name: LimbPoint): Vector3 => out[`${side}_${name}`];
    const isFound = (name: LimbPoint): boolean => joints[`${side}_${name}`].length > 0;
    if (!isFound("hip")) {
      at("hip")
        .copy(out.hips)
        .addScaledVector(across, (sign * HIPS_PER_SHOULDERS) / 2);
    }
    const beyond = (name: LimbPoint, before: LimbPoint, share: number): Vector3 =>
      point.subVectors(at(name), at(before)).multiplyScalar(share);
    if (!isFound("fingers") || at("fingers").distanceToSquared(at("hand")) === 0) {
      at("fingers")
        .copy(at("hand"))
        .add(beyond("hand", "elbow", HAND_PER_FOREARM));
    }
    if (!isFound("toes"))
      at("toes")
        .copy(at("foot"))
        .add(forward(out).multiplyScalar(FOOT_PER_SHIN * at("knee").distanceTo(at("foot"))));
  }
  return out;
}

/** The direction that the hips face: a unit vector, or none where the hips have no width. */
function forward({ left_hip, right_hip, hips, neck }: Landmarks): Vector3 {
  const across = new Vector3().subVectors(left_hip, right_hip);
  return across.cross(new Vector3().subVectors(neck, hips)).normalize();
}
