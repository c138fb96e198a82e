/** What a page shows of the service, kept up to date with what it depends on. */
import { untrack } from "svelte";
import { server } from "./server.svelte";

/**
 * A value that is asked for whenever a reactive value changes that `load` reads before its first
 * `await`, and again when the service is back. Make it while a component starts.
 */
export class Resource<T> {
  value: T | undefined = $state.raw();
  failure: unknown = $state.raw();
  isLoading = $state(true);
  #asked = $state(0);

  constructor(load: (signal: AbortSignal) => Promise<T>) {
    $effect(() => {
      void [server.epoch, this.#asked];
      const abort = new AbortController();
      const loaded = load(abort.signal);
      untrack(() => void this.#take(loaded, abort.signal));
      return () => abort.abort();
    });
  }

  reload(): void {
    this.#asked += 1;
  }

  async #take(loaded: Promise<T>, signal: AbortSignal): Promise<void> {
    this.isLoading = true;
    try {
      const value = await loaded;
      if (signal.aborted) return;
      this.value = value;
      this.failure = undefined;
    } catch (failure) {
      if (signal.aborted) return;
      this.failure = failure;
    }
    this.isLoading = false;
  }
}
