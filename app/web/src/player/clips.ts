/** What a player plays. */
import type { Clip } from "$/api/client";
import { skeletonMotion, type SkeletonMotion } from "$/motion/motion";

export interface PlayerClip {
  /** Changes when what is loaded changes. */
  readonly key: string;
  readonly name: string;
  /** Names of joints by role, as far as they are known. */
  readonly roles: Readonly<Record<string, string>>;
  load(signal: AbortSignal): Promise<SkeletonMotion>;
  /** The clip's own time at a time of the player; by default the same. */
  at?(seconds: number): number;
  /** A color of each joint, 0xrrggbb, at a time of the player; null: those of its sides. */
  tint?(seconds: number): readonly number[] | null;
  readonly audio?: { readonly clipId: string; readonly begins: number };
}

const MAX_RATE = 60;
const MIN_RATE = 10;
/** Bytes of one motion in memory; longer ones have fewer frames a second. */
const MAX_BYTES = 32e6;
const BYTES_OF_JOINT = 12;

/** A stored clip as the player takes it. */
export function playerClip(clip: Clip): PlayerClip {
  return {
    key: clip.id,
    name: clip.name,
    roles: clip.roles,
    load: (signal) => skeletonMotion(clip.id, frameRateFor(clip), signal),
    ...(clip.has_audio && { audio: { clipId: clip.id, begins: clip.audio_offset ?? 0 } }),
  };
}

/** Frames a second at which a clip is loaded. */
export function frameRateFor(clip: Pick<Clip, "frame_rate" | "duration" | "joints">): number {
  const bytes = (clip.duration ?? 0) * (clip.joints ?? 0) * BYTES_OF_JOINT;
  const fitting = bytes > 0 ? Math.floor(MAX_BYTES / bytes) : MAX_RATE;
  const own = clip.frame_rate ?? MAX_RATE;
  return Math.max(MIN_RATE, Math.min(own, MAX_RATE, fitting));
}
