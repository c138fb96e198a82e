/** The order of hits that are shown. */
import type { Clip } from "$/api/client";
import type { Order } from "./arrangement";

type Measured = Pick<Clip, "duration" | "speed" | "travel" | "energy" | "tempo">;

/** By a measure of the clips, those without it last; "best" keeps the order of the answer. */
export function inOrder<H extends { readonly clip: Measured }>(
  hits: readonly H[],
  order: Order,
): readonly H[] {
  if (order === "best") return hits;
  const isFalling = order.startsWith("-");
  const name = order.replace("-", "") as keyof Measured;
  const rank = ({ clip }: H): number => {
    const value = clip[name];
    if (value === null) return Infinity;
    return isFalling ? -value : value;
  };
  return hits.toSorted((one, other) => {
    const [a, b] = [rank(one), rank(other)];
    return a === b ? 0 : a - b;
  });
}
