/** Do `work` for each item, at most `limit` at a time. A failure does not stop the others. */
export async function forEachOf<T>(
  items: readonly T[],
  limit: number,
  work: (item: T) => Promise<void>,
): Promise<{ item: T; failure: unknown }[]> {
  const failures: { item: T; failure: unknown }[] = [];
  const waiting = items.values();
  const worker = async (): Promise<void> => {
    for (const item of waiting) {
      try {
        await work(item);
      } catch (failure) {
        failures.push({ item, failure });
      }
    }
  };
  await Promise.all(Array.from({ length: limit }, worker));
  return failures;
}

/**
 * At most `limit` of the given works run at a time. Those that are given together, without a wait
 * between them, run in their order; the newest of such groups goes first, as readers scroll on.
 */
export class Turns {
  #running = 0;
  readonly #waiting: (() => void)[][] = [];
  #group: (() => void)[] | null = null;

  constructor(readonly limit: number) {}

  async take<T>(work: () => Promise<T>, signal: AbortSignal): Promise<T> {
    if (this.#running >= this.limit) {
      await new Promise<void>((go) => this.#wait(go));
    }
    this.#running += 1;
    try {
      signal.throwIfAborted();
      return await work();
    } finally {
      this.#running -= 1;
      this.#next()?.();
    }
  }

  #wait(go: () => void): void {
    if (!this.#group) {
      this.#waiting.push((this.#group = []));
      queueMicrotask(() => (this.#group = null));
    }
    this.#group.push(go);
  }

  #next(): (() => void) | undefined {
    const newest = this.#waiting.at(-1);
    const next = newest?.shift();
    if (newest?.length === 0) {
      this.#waiting.pop();
      if (newest === this.#group) this.#group = null;
    }
    return next;
  }
}
