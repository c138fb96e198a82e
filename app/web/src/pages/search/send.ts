/** Sends a search. */
import { api, ask, askFor, type Schemas } from "$/api/client";
import type { Asked } from "./address";

export type Found =
  Schemas["MotionHits"] | Schemas["WordHits"] | Schemas["PoseHits"] | Schemas["ComposedHits"];

/** file: what is sent where a file is the query. Throws ApiProblem, Away, AbortError. */
export async function send(asked: Asked, file: File | null, signal: AbortSignal): Promise<Found> {
  // The types name fields as needed that have a default: they are made for answers.
  if (asked.kind === "words") {
    const body = asked.body as unknown as Schemas["WordSearch"];
    return ask(api.POST("/v1/search/words", { body, signal }));
  }
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
