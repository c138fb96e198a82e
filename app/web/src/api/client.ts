/** Calls of the API, with the types of its own description. */
import createClient, { type Middleware } from "openapi-fetch";
import { root } from "$/core/root";
import { Away, problemOf } from "./problem";
import type { components, paths } from "./schema";
import { server } from "./server.svelte";

export type Schemas = components["schemas"];
export type Clip = Schemas["Clip"];

const MAX_TRIES = 3;
const UNAUTHORIZED = 401;
const BUSY = 503;

export const api = createClient<paths>({
  baseUrl: root || "/",
  fetch: fetchFromServer,
  querySerializer: { array: { style: "form", explode: true } },
});

/** Fetch, and notice that the service is away, or busy (then a read is tried again). */
export async function fetchFromServer(request: Request): Promise<Response> {
  for (let attempt = 1; ; attempt += 1) {
    const answer = await answered(request.clone());
    const isFinal = answer.status !== BUSY || request.method !== "GET" || attempt === MAX_TRIES;
    if (isFinal) return answer;
    await seconds(Number(answer.headers.get("Retry-After") ?? 1), request.signal);
  }
}

async function answered(request: Request): Promise<Response> {
  try {
    const answer = await fetch(request);
    server.found();
    return answer;
  } catch (failure) {
    if (request.signal.aborted) throw failure;
    server.lost();
    throw new Away();
  }
}

const noticing: Middleware = {
  onResponse({ response, schemaPath }) {
    if (response.status === UNAUTHORIZED && schemaPath !== "/v1/session") server.refused();
  },
};
api.use(noticing);

interface Answer<D> {
  data?: D;
  error?: unknown;
  response: Response;
}

/**
 * The data of a call that is answered with JSON; `askFor` reads other forms. Throws ApiProblem,
 * Away, AbortError.
 */
export async function ask<D>(call: Promise<Answer<D>>): Promise<Exclude<NonNullable<D>, string>> {
  const { data, error, response } = await call;
  if (!response.ok) throw problemOf(error, response.status);
  return data as Exclude<NonNullable<D>, string>;
}

/** Bytes or text from an address that the typed client does not read. Throws as `ask`. */
export async function askFor(path: string, init: RequestInit = {}): Promise<Response> {
  const answer = await fetchFromServer(new Request(root + path, init));
  if (answer.status === UNAUTHORIZED) server.refused();
  if (!answer.ok) throw problemOf(await answer.json().catch(() => null), answer.status);
  return answer;
}

function seconds(count: number, signal: AbortSignal): Promise<void> {
  return new Promise((resolve, reject) => {
    const timer = setTimeout(resolve, count * 1000);
    signal.addEventListener("abort", () => {
      clearTimeout(timer);
      reject(signal.reason as Error);
    });
  });
}
