/** Clips and parts that are set aside while one searches, to be put into a collection together. */

export interface Collected {
  readonly id: string;
  /** The part, seconds; null: of the clip. */
  readonly start: number | null;
  readonly end: number | null;
}

const KEY = "kinedex.basket";
const MAX = 1000;

export const nameOf = ({ id, start, end }: Collected): string =>
  `${id}@${start ?? ""}-${end ?? ""}`;

/** The items that a text holds; none where it cannot be read. */
export function readBasket(text: string | null): readonly Collected[] {
  try {
    const found: unknown = JSON.parse(text ?? "[]");
    return Array.isArray(found) ? (found as Collected[]).filter(({ id }) => id) : [];
  } catch {
    return [];
  }
}

class Basket {
  items: readonly Collected[] = $state.raw(readBasket(sessionStorage.getItem(KEY)));

  has(item: Collected): boolean {
    return this.items.some((one) => nameOf(one) === nameOf(item));
  }

  /** Put an item in, or take it out. */
  toggle(item: Collected): void {
    const others = this.items.filter((one) => nameOf(one) !== nameOf(item));
    this.#set(this.has(item) ? others : [...others, item].slice(-MAX));
  }

  clear(): void {
    this.#set([]);
  }

  #set(items: readonly Collected[]): void {
    this.items = items;
    sessionStorage.setItem(KEY, JSON.stringify(items));
  }
}

export const basket = new Basket();
