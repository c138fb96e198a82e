/** What is made, in the address. */
import { text } from "$/core/query";
import { PLAYER } from "$/player/view";

export const MAKE = {
  ...PLAYER,
  person: text(),
  /** Ids of clips of one person, with commas between them; they count instead of a person. */
  clips: text(),
  task: text(),
};

/** The largest number of clips that this page makes a motion of; each is asked for. */
export const MAX_OWN_CLIPS = 50;

/** The ids of the field `clips`, without repetitions. */
export function clipIds(clips: string): readonly string[] {
  const ids = clips.split(",").map((id) => id.trim());
  return [...new Set(ids)].filter((id) => id !== "").slice(0, MAX_OWN_CLIPS);
}
