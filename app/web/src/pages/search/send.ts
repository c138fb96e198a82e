/** Sends a search. */
import { api, ask, askFor, type Schemas } from "$/api/client";
import type { Asked } from "./address";
import { FACET_FIELDS, type Labeled } from "./facets";

export type Found =
  Schemas["MotionHits"] | Schemas["WordHits"] | Schemas["PoseHits"] | Schemas["ComposedHits"];

/** file: what is sent where a file is the query. Throws ApiProblem, Away, AbortError. */
export async function send(asked: Asked, file: File | null, signal: AbortSignal): Promise<Found> {
  // The types name fields as needed that have a default: they are made for answers.
  if (asked.kind === "words") {
    const body = asked.body as unknown as Schemas["WordSearch"];
    return ask(api.POST("/v1/search/words", { body, signal }));
  }
  if (asked.kind === "saved") {
    const params = { path: { search_id: asked.id }, query: { limit: asked.body.limit } };
    return ask(api.GET("/v1/searches/{search_id}/hits", { params, signal }));
  }
  if (asked.kind === "fresh") return sendFresh(asked.id, signal);
  if (asked.kind === "clip") {
    const body = asked.body as unknown as Schemas["MotionSearch"];
    return ask(api.POST("/v1/search/motion", { body, signal }));
  }
  if (asked.kind === "pose") {
    const body = asked.body as unknown as Schemas["PoseSearch"];
    return ask(api.POST("/v1/search/pose", { body, signal }));
  }
  if (asked.kind === "file") {
    return sendForm<Schemas["MotionHits"]>("/v1/search/motion", asked.body, file, signal);
  }
  if (asked.name) {
    return sendForm<Schemas["ComposedHits"]>("/v1/search", asked.body, file, signal);
  }
  const body = asked.body as unknown as Schemas["ComposedSearch"];
  return ask(api.POST("/v1/search", { body, signal }));
}

/** The new hits of a saved search in the form of other answers. */
async function sendFresh(id: string, signal: AbortSignal): Promise<Schemas["ComposedHits"]> {
  const params = { path: { search_id: id } };
  const begun = performance.now();
  const { items, library_version } = await ask(
    api.GET("/v1/searches/{search_id}/new", { params, signal }),
  );
  return {
    method: "new",
    took_ms: performance.now() - begun,
    library_version,
    items,
    next: null,
    unknown_words: [],
    expanded: {},
    confidence: {},
  };
}

const FACETED = 200;
/** A hit of words or of several parts is likely from here on; nearer examples are just nearer. */
const LIKELY = 0.5;
const PATHS = {
  words: "/v1/search/words",
  clip: "/v1/search/motion",
  parts: "/v1/search",
} as const;

/**
 * The labels of the clips that the facets of a query count: of the likely ones among the best hits,
 * else of all of these. Null for a query that has no facets. Throws as `send`.
 */
export async function sendFacets(
  asked: Asked,
  signal: AbortSignal,
): Promise<readonly Labeled[] | null> {
  if (asked.kind !== "words" && asked.kind !== "clip" && asked.kind !== "parts") return null;
  if (asked.kind === "parts" && asked.name) return null;
  const fields = new URLSearchParams(
    ["score", ...FACET_FIELDS].map((name): [string, string] => ["fields", name]),
  );
  const answer = await askFor(`${PATHS[asked.kind]}?${fields.toString()}`, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify({ ...asked.body, limit: FACETED }),
    signal,
  });
  const { items } = (await answer.json()) as { items: FacetHit[] };
  const likely = asked.kind === "clip" ? [] : items.filter(({ score }) => score >= LIKELY);
  const counted = likely.length > 0 ? likely : items;
  // Several parts of a clip are hits, where parts are found; the clip counts once.
  return [...new Map(counted.map(({ clip }) => [clip.id, clip])).values()];
}

interface FacetHit {
  readonly score: number;
  readonly clip: Labeled & { readonly id: string };
}

async function sendForm<T>(
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
