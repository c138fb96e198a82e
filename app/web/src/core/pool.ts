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

/** At most `limit` of the given works run at a time; the newest goes first, as readers scroll on. */
export class Turns {
  #running = 0;
  readonly #waiting: (() => void)[] = [];

  constructor(readonly limit: number) {}

  async take<T>(work: () => Promise<T>, signal: AbortSignal): Promise<T> {
    if (this.#running >= this.limit) {
      await new Promise<void>((go) => this.#waiting.push(go));
    }
    this.#running += 1;
    try {
      signal.throwIfAborted();
      return await work();
    } finally {
      this.#running -= 1;
      this.#waiting.pop()?.();
    }
  }
}
