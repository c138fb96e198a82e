import { describe, expect, it } from "vitest";
import type { SkeletonMotion } from "$/motion/motion";
import { length, poseAt, rigOf, type PoseOptions } from "./pose";

/** Hips that walk along x, and a hand on each side of them. */
const MOTION: SkeletonMotion = {
  names: ["Hips", "LeftHand", "RightHand"],
  parents: [-1, 0, 0],
  frameRate: 10,
  frames: 2,
  joints: 3,
  positions: new Float32Array([1, 1, 0, 2, 1.5, 0, 0, 1, 0, 3, 1, 2, 4, 1.5, 2, 2, 1, 2]),
};
const PLAIN: PoseOptions = { inPlace: false, mirror: false };
const rig = rigOf(MOTION, "Hips");

function pose(seconds: number, options = PLAIN): number[][] {
  const out = new Float32Array(9);
  poseAt(rig, seconds, options, out);
  return [0, 1, 2].map((joint) => [...out.slice(joint * 3, joint * 3 + 3)]);
}

describe("the pose at a time", () => {
  it("is between the frames, and stays at the ends", () => {
    expect(length(MOTION)).toBeCloseTo(0.1);
    expect(pose(0.05)[0]).toEqual([2, 1, 1]);
    expect(pose(-1)).toEqual(pose(0));
    expect(pose(9)).toEqual(pose(0.1));
  });

  it("stays in place", () => {
    expect(pose(0.1, { inPlace: true, mirror: false })[0]).toEqual([1, 1, 0]);
    expect(pose(0.1, { inPlace: true, mirror: false })[1]).toEqual([2, 1.5, 0]);
  });

  it("is mirrored at the place where the hips began", () => {
    const [hips, left, right] = pose(0, { inPlace: false, mirror: true });
    expect(hips).toEqual([1, 1, 0]);
    expect(left).toEqual([2, 1, 0]);
    expect(right).toEqual([0, 1.5, 0]);
  });

  it("twice mirrored is itself", () => {
    expect(rig.mirrors.map((other) => rig.mirrors[other])).toEqual([0, 1, 2]);
    expect(rigOf(MOTION, undefined).root).toBe(0);
  });
});
