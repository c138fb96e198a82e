/** The clip page's state in its address. */
import { number, text } from "$/core/query";
import { PLAYER } from "$/player/view";

const MAX_DIMENSIONS = 1000;

export const CLIP = {
  ...PLAYER,
  /** Ids of clips that play beside it, separated by spaces or commas. */
  with: text(),
  /** The number of dimensions of the version that plays beside it. */
  k: number(null, 1, MAX_DIMENSIONS),
  /** The annotation, or the suggestion, that is chosen. */
  at: text(),
};

export const MAX_BESIDE = 3;

export function beside(text: string): readonly string[] {
  return text.split(/[ ,]+/).filter(Boolean).slice(0, MAX_BESIDE);
}
