/** A part of what a player plays. */
import type { SkeletonMotion } from "$/motion/motion";
import type { PlayerClip } from "./clips";

/** The clip from `start` to `end` (seconds; null: its own), whose time begins at 0. */
export function partOf(clip: PlayerClip, start: number | null, end: number | null): PlayerClip {
  if (start === null && end === null) return clip;
  const { audio } = clip;
  const from = start ?? 0;
  return {
    ...clip,
    key: `${clip.key}@${from}-${end ?? ""}`,
    load: async (signal) => cut(await clip.load(signal), from, end),
    ...(audio && { audio: { ...audio, begins: audio.begins - from } }),
  };
}

/** The frames within [start, end] seconds; at least one. */
export function cut(motion: SkeletonMotion, start: number, end: number | null): SkeletonMotion {
  const { frames, frameRate, joints, positions } = motion;
  const last = frames - 1;
  const first = Math.min(Math.max(0, Math.round(start * frameRate)), last);
  const until = end === null ? last : Math.min(Math.max(first, Math.round(end * frameRate)), last);
  const size = joints * 3;
  return {
    ...motion,
    frames: until - first + 1,
    positions: positions.subarray(first * size, (until + 1) * size),
  };
}
