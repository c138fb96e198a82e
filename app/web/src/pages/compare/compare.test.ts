import { describe, expect, it } from "vitest";
import type { SkeletonMotion } from "$/motion/motion";
import { comparing } from "./address";
import { facingAhead, hipHeight, inBodyFrame, rolesOfJoints } from "./bodies";
import type { Alignment } from "./path";
import { colorOf, inCm, topOf } from "./scale";

const NAMES = ["Hips", "LArm", "RArm", "LHand", "LThumb"];
const ROLES = {
  hips: "Hips",
  left_shoulder: "LArm",
  right_shoulder: "RArm",
  left_hand: "LHand",
};

/** Two frames of a body that looks along X, at (2, 1, 3) and (4, 1, 3). */
const aside: SkeletonMotion = {
  names: NAMES,
  parents: [-1, 0, 0, 1, 3],
  frameRate: 10,
  frames: 2,
  joints: 5,
  positions: new Float32Array(
    [2, 4].flatMap((x) => [x, 1, 3, x, 1.5, 2.8, x, 1.5, 3.2, x + 1, 1.5, 2.8, x + 1, 1.5, 2.8]),
  ),
};
const point = ({ positions, joints }: SkeletonMotion, frame: number, joint: number): number[] => {
  const at = (frame * joints + joint) * 3;
  return [...positions.subarray(at, at + 3)].map((value) => Number(value.toFixed(3)) + 0);
};

describe("bodies to compare", () => {
  it("look ahead, and keep their way", () => {
    const turned = facingAhead(aside, ROLES, 0);
    const [fromX = 0, , fromZ = 0] = point(turned, 0, 0);
    const [toX = 0, , toZ = 0] = point(turned, 1, 0);
    expect(toX - fromX).toBeCloseTo(0);
    expect(toZ - fromZ).toBeCloseTo(2);
  });

  it("have their hips at one place in the body frame, and the wanted size", () => {
    const local = inBodyFrame(aside, ROLES, 2, 0.9);
    for (const frame of [0, 1]) {
      expect(point(local, frame, 0)).toEqual([0, 0.9, 0]);
      expect(point(local, frame, 1)).toEqual([0.4, 1.9, 0]);
      expect(point(local, frame, 3)).toEqual([0.4, 1.9, 2]);
    }
  });

  it("stay as they are where no joint tells where they look", () => {
    expect(facingAhead(aside, { hips: "Hips" }, 0).positions).toEqual(aside.positions);
  });

  it("have the height of their hips", () => {
    expect(hipHeight(aside, ROLES)).toBeCloseTo(1);
  });

  it("give a finger the role of its hand, and the rest that of what they hang on", () => {
    const joints = ["hips", "left_hand"];
    expect(rolesOfJoints(aside, ROLES, joints)).toEqual([0, 0, 0, 1, 1]);
    expect(rolesOfJoints(aside, {}, joints)).toEqual([-1, -1, -1, -1, -1]);
  });
});

describe("the scale of differences", () => {
  const of = (...differences: number[][]): Alignment => ({
    distance: 0,
    body_lengths: [1, 1],
    path: [],
    joints: [],
    differences,
    mean_differences: [],
    peaks: [],
  });

  it("ends at a round number that few differences exceed", () => {
    expect(topOf(of([0, 0.01]))).toBeCloseTo(0.1);
    expect(topOf(of(Array.from({ length: 100 }, (_, place) => place / 100)))).toBeCloseTo(0.95);
  });

  it("gives the last color to all beyond its end", () => {
    const ramp = [
      [0, 0, 0],
      [255, 128, 1],
    ] as const;
    expect(colorOf(0, 0.2, ramp)).toBe(0);
    expect(colorOf(0.2, 0.2, ramp)).toBe(0xff8001);
    expect(colorOf(0.9, 0.2, ramp)).toBe(0xff8001);
  });

  it("says centimeters", () => {
    expect(inCm(0.312)).toBe("31 cm");
    expect(inCm(0.0312)).toBe("3.1 cm");
  });
});

it("an address names both clips and their parts", () => {
  expect(comparing({ id: "x" }, { id: "y", from: 0, to: 2.5 })).toEqual({
    a: "x",
    b: "y",
    b_from: "0",
    b_to: "2.5",
  });
});
