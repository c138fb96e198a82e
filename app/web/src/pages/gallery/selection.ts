/** Which clips are chosen, and how a click changes that. */

/** An address holds this many ids; a larger choice lives as long as the page. */
export const MAX_IN_ADDRESS = 40;

export interface Choice {
  readonly ids: ReadonlySet<string>;
  /** Where a range begins: what was last clicked. */
  readonly anchor: string | null;
}

export const NONE: Choice = { ids: new Set(), anchor: null };

export function toggled(choice: Choice, id: string): Choice {
  const ids = new Set(choice.ids);
  if (!ids.delete(id)) ids.add(id);
  return { ids, anchor: id };
}

/** With all from the anchor to `id` in the order shown; like `toggled` where there is no anchor. */
export function extended(choice: Choice, id: string, order: readonly string[]): Choice {
  const [from, to] = [order.indexOf(choice.anchor ?? ""), order.indexOf(id)];
  if (from < 0 || to < 0) return toggled(choice, id);
  const range = order.slice(Math.min(from, to), Math.max(from, to) + 1);
  return { ids: new Set([...choice.ids, ...range]), anchor: choice.anchor };
}
