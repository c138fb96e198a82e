import { describe, expect, it } from "vitest";
import { mirrored, sideOf } from "./skeleton";

const PAIRS = [
  ["left_knee", "right_knee"],
  ["LeftUpLeg", "RightUpLeg"],
  ["mixamorig:LeftHand", "mixamorig:RightHand"],
  ["calf_l", "calf_r"],
  ["L_Shoulder", "R_Shoulder"],
  ["lFoot", "rFoot"],
  ["LFoot", "RFoot"],
  ["lfemur", "rfemur"],
  ["hand.L", "hand.R"],
  ["Bip01 L Thigh", "Bip01 R Thigh"],
] as const;

describe("sides of joints", () => {
  it.each(PAIRS)("%s and %s", (left, right) => {
    expect(sideOf(left)).toBe("left");
    expect(sideOf(right)).toBe("right");
    expect(mirrored(left)).toBe(right);
    expect(mirrored(right)).toBe(left);
  });

  it.each([
    "Hips",
    "ROOT",
    "spine_03",
    "LowerBack",
    "root",
    "lowerback",
    "rib",
    "pelvis",
    "neck_01",
  ])("%s is of the trunk", (name) => {
    expect(sideOf(name)).toBe("trunk");
    expect(mirrored(name)).toBe(name);
  });
});
