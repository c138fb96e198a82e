/** Which hits of a query the map lights. */
import type { Asked } from "$/pages/search/address";
import type { Found } from "$/pages/search/send";

/** A clip carries the words more likely than not from here on. */
const LIKELY = 0.5;

/** Ids of the hits: of words and parts those that are likely, of an example the nearest. */
export function litIds({ kind }: Asked, { items }: Found): string[] {
  const isLit = (score: number): boolean =>
    (kind !== "words" && kind !== "parts") || score >= LIKELY;
  return items.filter(({ score }) => isLit(score)).map(({ clip }) => clip.id);
}
