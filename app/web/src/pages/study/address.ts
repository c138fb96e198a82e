/** The state of the blind study in its address. */
import { flag, text } from "$/core/query";
import { PLAYER } from "$/player/view";

export const STUDY = {
  ...PLAYER,
  /** Id of the pair that is judged. */
  pair: text(),
  /** Whether the votes so far are shown. */
  tally: flag(false),
};

/** Some of the ids in a random order; random: as Math.random. */
export function drawn(ids: readonly string[], most: number, random: () => number): string[] {
  const left = [...ids];
  const chosen: string[] = [];
  while (chosen.length < most && left.length > 0) {
    chosen.push(...left.splice(Math.floor(random() * left.length), 1));
  }
  return chosen;
}
