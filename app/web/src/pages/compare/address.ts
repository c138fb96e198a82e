/** The state of a comparison in its address. */
import { choice, flag, number, text } from "$/core/query";
import { PLAYER } from "$/player/view";

const MAX_SECONDS = 1e6;

export const COMPARE = {
  ...PLAYER,
  /** In place: two that walk at different speeds would part. */
  place: flag(true),
  /** Ids of the two clips. */
  a: text(),
  b: text(),
  /** The parts that are compared, seconds of each clip; null: its own start or end. */
  a_from: number(null, 0, MAX_SECONDS),
  a_to: number(null, 0, MAX_SECONDS),
  b_from: number(null, 0, MAX_SECONDS),
  b_to: number(null, 0, MAX_SECONDS),
  /** Beside each other, or one over the other. */
  view: choice(["beside", "over"], "beside"),
  /** Both run by the same clock, instead of along the path. */
  clock: flag(false),
  /** The joint that is marked; the others lose their colors. */
  joint: text(),
};

/** A clip, or a part of it in seconds. */
export interface Side {
  readonly id: string;
  readonly from?: number | null;
  readonly to?: number | null;
}

/** The query of the address that compares two clips. */
export function comparing(a: Side, b: Side): Record<string, string> {
  return { ...named("a", a), ...named("b", b) };
}

function named(name: "a" | "b", { id, from = null, to = null }: Side): Record<string, string> {
  return {
    [name]: id,
    ...(from !== null && { [`${name}_from`]: String(from) }),
    ...(to !== null && { [`${name}_to`]: String(to) }),
  };
}
