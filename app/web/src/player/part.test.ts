import { expect, it } from "vitest";
import type { SkeletonMotion } from "$/motion/motion";
import { cut, partOf } from "./part";

const MOTION: SkeletonMotion = {
  names: ["hips"],
  parents: [-1],
  frameRate: 2,
  frames: 5,
  joints: 1,
  positions: Float32Array.from({ length: 15 }, (_, index) => Math.floor(index / 3)),
};
const frames = (motion: SkeletonMotion): number[] =>
  [...motion.positions].filter((_, index) => index % 3 === 0);

it("a part has the frames from its start to its end", () => {
  expect(frames(cut(MOTION, 0.5, 1.5))).toEqual([1, 2, 3]);
  expect(frames(cut(MOTION, 1, null))).toEqual([2, 3, 4]);
  expect(frames(cut(MOTION, 99, 3))).toEqual([4]);
});

it("a part is loaded as itself, and its sound stays in step", async () => {
  const clip = {
    key: "c",
    name: "c",
    roles: {},
    load: () => Promise.resolve(MOTION),
    audio: { clipId: "c", begins: 0.25 },
  };
  const part = partOf(clip, 1, 2);
  expect(part.key).not.toBe(clip.key);
  expect(part.audio?.begins).toBe(-0.75);
  expect((await part.load(new AbortController().signal)).frames).toBe(3);
  expect(partOf(clip, null, null)).toBe(clip);
});
