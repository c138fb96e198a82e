/** Groups of near-duplicates as people read them. */
import type { Clip, Schemas } from "$/api/client";
import { count, duration, label } from "$/core/format";
import { PAIRS } from "./address";

type Group = Pick<Schemas["DuplicateGroup"], "keeper" | "clips" | "pairs">;
type Pair = Schemas["DuplicatePair"];

/** The pair of two clips, whichever comes first; else undefined. */
export function pairOf(pairs: readonly Pair[], one: string, other: string): Pair | undefined {
  return pairs.find(
    ({ clip_id: a, other_id: b }) => (a === one && b === other) || (a === other && b === one),
  );
}

/** Why a clip is in a group: how it is the same as the keeper, or as another one. */
export function reasonOf({ keeper, clips, pairs }: Group, id: string): string {
  if (id === keeper) return "proposed to be kept";
  const direct = pairOf(pairs, keeper, id);
  if (direct) return `${PAIRS[direct.kind]}, ${distanceOf(direct)}`;
  const pair = pairs.find(({ clip_id, other_id }) => clip_id === id || other_id === id);
  if (!pair) return "";
  const other = clips.find(
    (clip) => clip.id !== id && [pair.clip_id, pair.other_id].includes(clip.id),
  );
  return `${PAIRS[pair.kind]}, as ${other?.name ?? "another one"}`;
}

const distanceOf = ({ distance }: Pair): string =>
  distance < 0.0005 ? "no difference" : `distance ${Number(distance.toPrecision(2))}`;

/** What makes one clip worth more than another. */
export function factsOf(clip: Clip): string {
  return [
    duration(clip.duration),
    clip.frame_rate && `${Number(clip.frame_rate.toFixed(2))} Hz`,
    clip.joints && `${count(clip.joints)} joints`,
    clip.format?.toUpperCase(),
  ]
    .filter(Boolean)
    .join(" · ");
}

/** Seconds of `other` at a time of `keeper`, so that both are at the same moment of the take. */
export function apartOf(pair: Pair | undefined, keeper: string): number {
  if (!pair) return 0;
  return pair.clip_id === keeper ? -pair.shift : pair.shift;
}

/** Who, what and which words, each once. */
export function labelsOf({ person, task, words }: Pick<Clip, "person" | "task" | "words">): string {
  const labels = new Set([person, task, ...words].filter((one) => one !== null));
  return [...labels].map(label).join(", ") || "no labels";
}
