/** The clips of a query, loaded page by page as the reader goes on. */
import { api, ask, type Clip } from "$/api/client";
import { Kept } from "$/core/kept";
import type { ClipQuery } from "./address";

/** The first page fills a screen soon; those that follow are large. */
const FIRST_PAGE = 100;
const PAGE = 500;
const MAX_PAGE = 1000;

export class Feed {
  clips: readonly Clip[] = $state.raw([]);
  isWhole = $state(false);
  /** How many clips the query has, also those that are not loaded; null until it is known. */
  total: number | null = $state(null);
  isExact = $state(true);
  failure: unknown = $state.raw();
  readonly #query: ClipQuery;
  #cursor: string | null = null;
  #loading: Promise<void> | null = null;

  constructor(query: ClipQuery) {
    this.#query = query;
  }

  /** Load the next page; does nothing when all are there or one is on its way. */
  more(limit = this.clips.length > 0 ? PAGE : FIRST_PAGE): Promise<void> {
    if (this.isWhole) return Promise.resolve();
    this.#loading ??= this.#load(limit);
    return this.#loading;
  }

  /** Load all that is left. Throws as the API's calls do. */
  async all(): Promise<readonly Clip[]> {
    while (!this.isWhole) {
      await this.more(MAX_PAGE);
      if (this.failure !== undefined) throw this.failure;
    }
    return this.clips;
  }

  /** Show clips as they are now, after a change. */
  replace(changed: readonly Clip[]): void {
    const byId = new Map(changed.map((clip) => [clip.id, clip]));
    this.clips = this.clips.map((clip) => byId.get(clip.id) ?? clip);
  }

  remove(ids: ReadonlySet<string>): void {
    const before = this.clips.length;
    this.clips = this.clips.filter((clip) => !ids.has(clip.id));
    if (this.total !== null) this.total -= before - this.clips.length;
  }

  async #load(limit: number): Promise<void> {
    try {
      const query = {
        ...this.#query,
        limit,
        ...(this.#cursor === null ? {} : { cursor: this.#cursor }),
      };
      const page = await ask(api.GET("/v1/clips", { params: { query } }));
      this.#loading = null; // before the clips show: the grid may ask for more at once
      this.clips = [...this.clips, ...page.items];
      this.#cursor = page.next;
      [this.total, this.isExact] = [page.total, page.total_is_exact];
      this.isWhole = page.next === null;
      this.failure = undefined;
    } catch (failure) {
      this.#loading = null;
      this.failure = failure;
    }
  }
}

const MAX_KEPT = 8;
const feeds = new Kept<string, Feed>(MAX_KEPT);

/** The feed of a query: the one that was shown before, when the reader comes back to it. */
export function feedOf(query: ClipQuery): Feed {
  const key = JSON.stringify(query);
  const feed = feeds.get(key) ?? new Feed(query);
  feeds.set(key, feed);
  return feed;
}

/** Feeds that were loaded do not count any more: the library has changed. */
export function forgetFeeds(): void {
  feeds.clear();
}
