/** Sends a search. */
import { api, ask, type Schemas } from "$/api/client";
import { LABELS, type Asked } from "./address";
import {
  composedOfGiven,
  isForSomething,
  isOfWholeClips,
  sendComposed,
  sendForm,
  type Composed,
} from "./composed";
import { countsOfClips, countsOfFacets, FACET_FIELDS, type Counted, type Labeled } from "./facets";

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
/** A hit is likely from here on, where its score is a probability. */
const LIKELY = 0.5;
const PATHS = { words: "/v1/search/words", clip: "/v1/search/motion" } as const;

/**
 * The labels of the hits, counted: of the likely ones, else of all. Of other
 * queries, those of the clips of the best hits. Null for a query that has no facets. Throws as `send`.
 */
export async function sendFacets(
  asked: Asked,
  file: File | null,
  signal: AbortSignal,
): Promise<Counted | null> {
  const isFileMissing = asked.kind === "file" || (asked.kind === "parts" && asked.name !== "");
  // A filter in the address cannot narrow a query that the address does not say.
  if (asked.kind === "saved" || asked.kind === "fresh" || (isFileMissing && !file)) return null;
  if (!isOfWholeClips(asked) || !isForSomething(asked)) return sendFacetsOfBest(asked, signal);
  const query = composedOfGiven(asked);
  const least = Number(query.min_score ?? LIKELY);
  const counted = await sendCounts({ ...query, min_score: least }, file, signal);
  if (counted.count > 0 || query.min_score !== undefined) return { ...counted, of: "likely" };
  return { ...(await sendCounts(query, file, signal)), of: "all" };
}

async function sendCounts(
  query: Composed,
  file: File | null,
  signal: AbortSignal,
): Promise<Omit<Counted, "of">> {
  const body = { ...query, limit: 1, facets: LABELS };
  const path = "/v1/search?fields=rank";
  const { facets } = await sendComposed<Pick<Schemas["ComposedHits"], "facets">>(
    path,
    body,
    file,
    signal,
  );
  return countsOfFacets(facets ?? {});
}

async function sendFacetsOfBest(asked: Asked, signal: AbortSignal): Promise<Counted | null> {
  if (asked.kind !== "words" && asked.kind !== "clip") return null;
  const fields = new URLSearchParams(
    FACET_FIELDS.map((name): [string, string] => ["fields", name]),
  );
  const { items } = await sendComposed<{ items: FacetHit[] }>(
    `${PATHS[asked.kind]}?${fields.toString()}`,
    { ...asked.body, limit: FACETED },
    null,
    signal,
  );
  // Several parts of a clip are hits; the clip counts once.
  const clips = [...new Map(items.map(({ clip }) => [clip.id, clip])).values()];
  return { ...countsOfClips(clips), of: "best" };
}

interface FacetHit {
  readonly clip: Labeled & { readonly id: string };
}
