/** Queries of every kind as `POST /v1/search` takes them: it counts facets and explains hits. */
import { api, ask, askFor, type Schemas } from "$/api/client";
import type { Asked } from "./address";
import type { Example } from "./parts";
import type { QueryParts } from "./scores";
import { wordOf } from "./words";

type ComposedExample = Pick<Schemas["SearchExample"], "clip_id"> &
  Partial<Pick<Schemas["SearchExample"], "start" | "end">>;

/** The body of a search by several parts; an uploaded file goes beside it. */
export interface Composed {
  readonly examples?: readonly ComposedExample[];
  readonly words?: readonly string[];
  readonly [name: string]: unknown;
}

/** Whether the hits are whole clips: only these are the hits of a search by several parts. */
export function isOfWholeClips(asked: Asked): boolean {
  return !("body" in asked && "scope" in asked.body) || asked.body.scope === "clips";
}

/** Whether the query is for something: words that are all against something are no such query. */
export function isForSomething(asked: Asked): boolean {
  return asked.kind !== "words" || asked.body.words.some((word) => !wordOf(word).isMinus);
}

/** The query without its page and scope. Throws ApiProblem, Away, AbortError for a saved one. */
export async function composedOf(asked: Asked, signal: AbortSignal): Promise<Composed> {
  if (asked.kind === "saved" || asked.kind === "fresh") {
    const params = { path: { search_id: asked.id } };
    const { query } = await ask(api.GET("/v1/searches/{search_id}", { params, signal }));
    return withoutPage(query as Record<string, unknown>);
  }
  return composedOfGiven(asked);
}

type Given = Exclude<Asked, { readonly kind: "saved" | "fresh" }>;

/** The same of a query that the address says. */
export function composedOfGiven(asked: Given): Composed {
  const body = withoutPage(asked.body);
  if (asked.kind === "pose") {
    const { clip_id, time, ...others } = body;
    return { ...others, poses: { sequence: [{ clip_id, time }] } };
  }
  if (asked.kind !== "clip") return body;
  const { clip_id, start, end, ...others } = body;
  const example = {
    clip_id: clip_id as string,
    ...(start !== undefined && { start: start as number }),
    ...(end !== undefined && { end: end as number }),
  };
  return { ...others, examples: [example] };
}

function withoutPage(query: object): Record<string, unknown> {
  const page = new Set(["limit", "cursor", "scope", "tempo"]);
  return Object.fromEntries(
    Object.entries(query).filter(([name, value]) => !page.has(name) && value !== null),
  );
}

/** What the parts of a query are named by. file: the name of the uploaded one, or "". */
export function partsOf(query: Composed, file: string): QueryParts {
  const examples = (query.examples ?? []).map(({ clip_id, start, end }): Example => ({
    id: clip_id,
    start: start ?? null,
    end: end ?? null,
    isAgainst: false,
  }));
  return { examples, words: query.words ?? [], file };
}

/** Send JSON, or a form where a file is a part of the query. Throws as `composedOf`. */
export async function sendComposed<T>(
  path: string,
  body: object,
  file: File | null,
  signal: AbortSignal,
): Promise<T> {
  if (file) return sendForm<T>(path, body, file, signal);
  const answer = await askFor(path, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(body),
    signal,
  });
  return (await answer.json()) as T;
}

export async function sendForm<T>(
  path: string,
  body: object,
  file: File | null,
  signal: AbortSignal,
): Promise<T> {
  const form = new FormData();
  for (const [name, value] of Object.entries(body)) {
    form.append(name, typeof value === "object" ? JSON.stringify(value) : String(value));
  }
  if (file) form.append("file", file);
  const answer = await askFor(path, { method: "POST", body: form, signal });
  return (await answer.json()) as T;
}
