/** The order of a collection. */

/** With the item at one place put at another; places beyond the ends count as the ends. */
export function moved<T>(items: readonly T[], from: number, to: number): readonly T[] {
  const item = items[from];
  if (item === undefined) return items;
  const others = items.filter((_, place) => place !== from);
  const place = Math.min(Math.max(0, to), others.length);
  return [...others.slice(0, place), item, ...others.slice(place)];
}
