/** A body at rest, made to the measure of a clip: standing, the arms a little from the body. */
import { Quaternion, Vector3 } from "three";
import type { SkeletonMotion } from "$/motion/motion";
import { emptyLandmarks, landmarksOf, SIDES, type Anatomy, type Landmarks } from "./anatomy";
import { chestTurn, pelvisTurn } from "./frames";

export interface Rest {
  readonly at: Landmarks;
  /** Meters: the height of the person from the floor to the top of the head. */
  readonly stature: number;
}

/** Frames in which a body is measured. */
const MAX_SAMPLED = 48;
/** Legs from the hip and the trunk to the neck, as a share of the stature; the height of the ankle
    likewise (Drillis & Contini, in Winter 2009, fig. 4.1). */
const LEGS_AND_TRUNK = 0.8;
const ANKLE = 0.039;
const TOES = { forward: 0.1, down: 0.028 };
const FINGERS = 0.05;
/** Radians: arms and legs from the vertical. */
const ARMS = 0.75;
const LEGS = 0.07;

type Measure = (at: Landmarks) => number;

/** The rest of the body in a motion. Its landmarks are finite; a body without a size has none. */
export function restOf(motion: SkeletonMotion, anatomy: Anatomy): Rest {
  const measured = poses(motion, anatomy);
  const median = (measure: Measure): number => middle(measured.map(measure));
  const length = (from: Point, to: Point): number =>
    median((at) => SIDES.reduce((sum, side) => sum + span(at, side, from, to) / 2, 0));
  const offset = (turn: (at: Landmarks) => Quaternion, from: "hips" | "neck", to: Point): Vector3 =>
    vector((axis) => median((at) => local(turn(at), at, from, to)[axis]));

  const [thigh, shin] = [length("hip", "knee"), length("knee", "foot")];
  const [upper, fore] = [length("shoulder", "elbow"), length("elbow", "hand")];
  const low = median((at) => at.hips.distanceTo(at.waist));
  const high = median((at) => at.waist.distanceTo(at.neck));
  const head = vector((axis) =>
    median((at) => turnedBack(chestTurn(at), at.neck, at.head)[axis]),
  ).setX(0);
  const stature = (thigh + shin + low + high) / LEGS_AND_TRUNK;
  const hip = offset(pelvisTurn, "hips", "hip");
  const shoulder = offset(chestTurn, "neck", "shoulder");

  const at = emptyLandmarks();
  at.hips.y = ANKLE * stature + (thigh + shin) * Math.cos(LEGS) - hip.y;
  at.waist.copy(at.hips).y += low;
  at.neck.copy(at.waist).y += high;
  at.head.copy(at.neck).add(head);
  for (const [side, sign] of [
    ["left", 1],
    ["right", -1],
  ] as const) {
    const put = (name: Point, from: Vector3, x: number, y: number, z: number): Vector3 =>
      at[`${side}_${name}`].copy(from).add(new Vector3(sign * x, y, z));
    const limb = (name: Point, from: Vector3, reach: number, angle: number): Vector3 =>
      put(name, from, reach * Math.sin(angle), -reach * Math.cos(angle), 0);
    const arm = put("shoulder", at.neck, shoulder.x, shoulder.y, shoulder.z);
    const hand = limb("hand", limb("elbow", arm, upper, ARMS), fore, ARMS);
    limb("fingers", hand, FINGERS * stature, ARMS);
    const leg = put("hip", at.hips, hip.x, hip.y, hip.z);
    const foot = limb("foot", limb("knee", leg, thigh, LEGS), shin, LEGS);
    put("toes", foot, 0, -TOES.down * stature, TOES.forward * stature);
  }
  return { at, stature };
}

type Point = "shoulder" | "elbow" | "hand" | "fingers" | "hip" | "knee" | "foot" | "toes";

function poses({ positions, joints, frames }: SkeletonMotion, anatomy: Anatomy): Landmarks[] {
  const step = Math.max(1, Math.floor(frames / MAX_SAMPLED));
  const found: Landmarks[] = [];
  for (let frame = 0; frame < frames; frame += step) {
    const pose = positions.subarray(frame * joints * 3, (frame + 1) * joints * 3);
    found.push(landmarksOf(anatomy, pose, emptyLandmarks()));
  }
  return found;
}

function span(at: Landmarks, side: "left" | "right", from: Point, to: Point): number {
  return at[`${side}_${from}`].distanceTo(at[`${side}_${to}`]);
}

/** The middle of a point of both sides, as one of the left side, as the turned trunk sees it. */
function local(turn: Quaternion, at: Landmarks, from: "hips" | "neck", to: Point): Vector3 {
  const left = turnedBack(turn, at[from], at[`left_${to}`]);
  const right = turnedBack(turn, at[from], at[`right_${to}`]);
  return left.add(right.setX(-right.x)).divideScalar(2);
}

function turnedBack(turn: Quaternion, from: Vector3, to: Vector3): Vector3 {
  return new Vector3().subVectors(to, from).applyQuaternion(turn.clone().invert());
}

function vector(value: (axis: "x" | "y" | "z") => number): Vector3 {
  return new Vector3(value("x"), value("y"), value("z"));
}

function middle(values: readonly number[]): number {
  return [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)] ?? 0;
}
