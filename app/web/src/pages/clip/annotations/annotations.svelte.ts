/** The annotations of a clip on the page: asked for, suggested, changed, and taken back. */
import { api, ask, type Schemas } from "$/api/client";
import { ApiProblem, inWords } from "$/api/problem";
import { Resource } from "$/api/resource.svelte";
import { notices } from "$/ui/notices.svelte";
import type { Part } from "./lanes";

export type Annotation = Schemas["Annotation"];
export type Suggested = Schemas["SuggestedAnnotation"];
/** What is said of a part. */
export type Said = Part & {
  readonly words: readonly string[];
  readonly person: string | null;
  readonly text: string | null;
};

const MAX_UNDONE = 100;

export class Annotations {
  items: readonly Annotation[] = $state.raw([]);
  suggested: readonly Suggested[] = $state.raw([]);
  readonly loaded: Resource<unknown>;
  /** How many changes can be taken back. */
  undoable = $state(0);
  readonly #clipId: () => string;
  #undos: (() => Promise<void>)[] = [];
  /** An annotation that comes back after its deletion has another id. */
  readonly #renamed = new Map<string, string>();

  /** Has an effect: make it while a component begins. */
  constructor(clipId: () => string) {
    this.#clipId = clipId;
    this.loaded = new Resource(async (signal) => {
      const params = { path: { clip_id: clipId() } };
      this.items = [];
      this.suggested = [];
      this.#undos = [];
      this.undoable = 0;
      const found = await ask(api.GET("/v1/clips/{clip_id}/annotations", { params, signal }));
      this.items = found.items;
      await this.#suggest(signal);
    });
  }

  /** The present id of an annotation. */
  idOf(id: string): string {
    const next = this.#renamed.get(id);
    return next === undefined ? id : this.idOf(next);
  }

  /** Null where it failed, which a notice says. */
  add(said: Said): Promise<Annotation | null> {
    return this.#done(async () => {
      const added = await this.#post(said);
      this.#keep(async () => this.#delete(added.id));
      return added;
    });
  }

  change(before: Annotation, changes: Partial<Said>): Promise<Annotation | null> {
    return this.#done(async () => {
      const names = Object.keys(changes) as (keyof Said)[];
      const back = Object.fromEntries(names.map((name) => [name, before[name]]));
      const changed = await this.#patch(before.id, changes);
      this.#keep(async () => void (await this.#patch(before.id, back)));
      return changed;
    });
  }

  async remove(gone: Annotation): Promise<void> {
    await this.#done(async () => {
      await this.#delete(gone.id);
      this.#keep(async () => {
        const { start, end, words, person, text, by } = gone;
        const back = await this.#post({ start, end, words, person, text, by });
        this.#renamed.set(this.idOf(gone.id), back.id);
      });
    });
  }

  /** Make annotations of suggestions. */
  async accept(some: readonly Part[]): Promise<Annotation | null> {
    return this.#done(async () => {
      const known = new Set(this.items.map(({ id }) => id));
      const params = { path: { clip_id: this.#clipId() } };
      const body = { items: some.map(({ start, end }) => ({ start, end })) };
      const path = "/v1/clips/{clip_id}/annotations/suggestions/accept";
      await ask(api.POST(path, { params, body }));
      await this.#reload();
      const added = this.items.filter(({ id }) => !known.has(id));
      this.#keep(async () => {
        for (const { id } of added) await this.#delete(id);
      });
      return added[0] ?? null;
    });
  }

  async undo(): Promise<void> {
    const undo = this.#undos.pop();
    this.undoable = this.#undos.length;
    if (undo) await this.#done(undo);
  }

  #keep(undo: () => Promise<void>): void {
    this.#undos = [...this.#undos, undo].slice(-MAX_UNDONE);
    this.undoable = this.#undos.length;
  }

  async #done<T>(work: () => Promise<T>): Promise<T | null> {
    try {
      const result = await work();
      void this.#suggest();
      return result;
    } catch (failure) {
      notices.show(inWords(failure).join(" "));
      return null;
    }
  }

  async #post(said: Said & { readonly by?: string | null }): Promise<Annotation> {
    const params = { path: { clip_id: this.#clipId() } };
    const body = { ...said, words: [...said.words] };
    const added = await ask(api.POST("/v1/clips/{clip_id}/annotations", { params, body }));
    this.#show([...this.items, added]);
    return added;
  }

  async #patch(id: string, changes: Partial<Said>): Promise<Annotation> {
    const params = { path: { clip_id: this.#clipId(), annotation_id: this.idOf(id) } };
    const { words, ...others } = changes;
    const body = { ...others, ...(words && { words: [...words] }) };
    const path = "/v1/clips/{clip_id}/annotations/{annotation_id}";
    const changed = await ask(api.PATCH(path, { params, body }));
    this.#show(this.items.map((one) => (one.id === changed.id ? changed : one)));
    return changed;
  }

  async #delete(id: string): Promise<void> {
    const now = this.idOf(id);
    const params = { path: { clip_id: this.#clipId(), annotation_id: now } };
    await ask(api.DELETE("/v1/clips/{clip_id}/annotations/{annotation_id}", { params }));
    this.#show(this.items.filter((one) => one.id !== now));
  }

  async #reload(): Promise<void> {
    const params = { path: { clip_id: this.#clipId() } };
    this.#show((await ask(api.GET("/v1/clips/{clip_id}/annotations", { params }))).items);
  }

  #show(items: readonly Annotation[]): void {
    this.items = items.toSorted((one, other) => one.start - other.start || one.end - other.end);
  }

  /** Suggestions are an offer: without a model there are none, and a failure says nothing. */
  async #suggest(signal?: AbortSignal): Promise<void> {
    const clipId = this.#clipId();
    const params = { path: { clip_id: clipId } };
    const path = "/v1/clips/{clip_id}/annotations/suggestions";
    try {
      const { items } = await ask(api.GET(path, { params, ...(signal && { signal }) }));
      if (clipId === this.#clipId()) this.suggested = items;
    } catch (failure) {
      if (!(failure instanceof ApiProblem)) throw failure;
      this.suggested = [];
    }
  }
}
