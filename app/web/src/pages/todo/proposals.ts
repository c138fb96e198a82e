/** What Kinedex would label a clip with, to be accepted one by one. */
import type { Clip, Schemas } from "$/api/client";

export interface Proposal {
  readonly field: "person" | "task" | "word";
  readonly value: string;
  readonly score: number;
  /** Likely enough to be accepted unless somebody says otherwise. */
  readonly isLikely: boolean;
}

const LEAST_SCORE = 0.05;
const LIKELY = 0.5;
/** Keys 1 to 9 choose them. */
const MAX_PROPOSALS = 9;

/** The labels that the clip lacks and the recognition names, the likeliest words last. */
export function proposals(
  found: Schemas["Recognition"],
  clip: Pick<Clip, "person" | "task" | "words">,
): readonly Proposal[] {
  const named = (["task", "person"] as const).flatMap((field): Proposal[] => {
    const guess = found[field];
    const value = guess?.label ?? guess?.candidates[0]?.label;
    if (!guess || !value || clip[field] || guess.score < LEAST_SCORE) return [];
    const isLikely = guess.known && guess.score >= LIKELY;
    return [{ field, value, score: guess.score, isLikely }];
  });
  const words = found.words
    .filter(({ word, score }) => score >= LEAST_SCORE && !clip.words.includes(word))
    .map(({ word, score }): Proposal => {
      return { field: "word", value: word, score, isLikely: score >= LIKELY };
    });
  return [...named, ...words].slice(0, MAX_PROPOSALS);
}

/** The change of a clip that accepts proposals. */
export function accepting(
  accepted: readonly Proposal[],
  clip: Pick<Clip, "words">,
): Schemas["ClipPatch"] {
  const patch: Schemas["ClipPatch"] = {};
  for (const { field, value } of accepted) {
    if (field !== "word") patch[field] = value;
  }
  const words = accepted.filter(({ field }) => field === "word").map(({ value }) => value);
  if (words.length > 0) patch.words = [...clip.words, ...words];
  return patch;
}
