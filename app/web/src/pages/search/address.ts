/** The search page's state in its address, and what it asks the API for. */
import type { Schemas } from "$/api/client";
import { choice, list, number, text, type Values } from "$/core/query";
import { PLAYER } from "$/player/view";

export const METHODS = {
  fused: "Fused",
  vector: "Vector",
  dtw: "DTW",
  "msv-dtw": "MSV by DTW",
  "msv-xcorr": "MSV by correlation",
  "metric-task": "Learned from tasks",
  "metric-person": "Learned from persons",
} as const;
export type Method = keyof typeof METHODS;

export const SCOPES = {
  clips: "Whole clips",
  windows: "Parts of clips",
  segments: "Between keyposes",
} as const;
export type Scope = keyof typeof SCOPES;

export const MODES = { default: "Regression", cca: "Correlated space" } as const;
export type Mode = keyof typeof MODES;

/** The methods of each scope, the default first. */
export const METHODS_OF: Readonly<Record<Scope, readonly Method[]>> = {
  clips: Object.keys(METHODS) as Method[],
  windows: ["fused", "vector", "dtw"],
  segments: ["fused", "vector"],
};

const MAX_SECONDS = 1e6;
/** Hits of one page, and at most: the API's limit. */
export const PAGE_SIZE = 24;
export const MAX_HITS = 1000;

export const SEARCH = {
  ...PLAYER,
  /** Words; one with a minus before it leaves out the clips that carry it. */
  q: list(),
  mode: choice(Object.keys(MODES) as Mode[], "default"),
  /** Id of the clip that is the query. */
  clip: text(),
  /** Name of the file that is the query; an address cannot hold the file itself. */
  file: text(),
  /** The part of the clip or the file, seconds. */
  start: number(null, 0, MAX_SECONDS),
  end: number(null, 0, MAX_SECONDS),
  /** The time of the pose of the clip that is the query, seconds; null: its motion is. */
  pose: number(null, 0, MAX_SECONDS),
  method: choice(Object.keys(METHODS) as Method[], "fused"),
  scope: choice(Object.keys(SCOPES) as Scope[], "clips"),
  person: list(),
  task: list(),
  word: list(),
  n: number(PAGE_SIZE, 1, MAX_HITS),
  /** Key of the hit that is in the player. */
  hit: text(),
};

export type SearchValues = Values<typeof SEARCH>;

export const FILTERS = ["person", "task", "word"] as const;
export type FilterName = (typeof FILTERS)[number];

type Filter = Partial<Record<FilterName, readonly string[]>>;
interface Options {
  readonly limit: number;
  readonly filter?: Filter;
}
interface MotionOptions extends Options {
  readonly method: Method;
  readonly scope: Scope;
  readonly start?: number;
  readonly end?: number;
}
interface WordOptions extends Options {
  readonly words: readonly string[];
  readonly mode: Mode;
}
interface PoseOptions extends Options {
  readonly clip_id: string;
  readonly time: number;
}
export type Asked =
  | { readonly kind: "pose"; readonly body: PoseOptions }
  | { readonly kind: "words"; readonly body: WordOptions }
  | { readonly kind: "clip"; readonly body: MotionOptions & { readonly clip_id: string } }
  | { readonly kind: "file"; readonly name: string; readonly body: MotionOptions };

/** What the address asks for; null where it asks for nothing. A motion goes before words. */
export function askedFor(values: SearchValues): Asked | null {
  if (values.clip && values.pose !== null) {
    return { kind: "pose", body: { clip_id: values.clip, time: values.pose, ...common(values) } };
  }
  if (values.clip) return { kind: "clip", body: { clip_id: values.clip, ...motion(values) } };
  if (values.file) return { kind: "file", name: values.file, body: motion(values) };
  if (values.q.length === 0) return null;
  const { mode } = values;
  return { kind: "words", body: { words: [...values.q], mode, ...common(values) } };
}

function motion(values: SearchValues): MotionOptions {
  return {
    method: values.method,
    scope: values.scope,
    ...(values.start !== null && { start: values.start }),
    ...(values.end !== null && { end: values.end }),
    ...common(values),
  };
}

function common(values: SearchValues): Options {
  const limit = values.n ?? PAGE_SIZE;
  const chosen = FILTERS.filter((name) => values[name].length > 0);
  if (chosen.length === 0) return { limit };
  return { limit, filter: Object.fromEntries(chosen.map((name) => [name, [...values[name]]])) };
}

export function isFiltered(values: SearchValues): boolean {
  return FILTERS.some((name) => values[name].length > 0);
}

export const UNFILTERED: Partial<SearchValues> = { person: [], task: [], word: [] };

/** What another query sets: its hits are others, and a part belongs to one motion. */
const OTHER_QUERY: Partial<SearchValues> = {
  q: [],
  clip: "",
  file: "",
  start: null,
  end: null,
  pose: null,
  n: PAGE_SIZE,
  hit: "",
  t: 0,
  from: null,
  to: null,
};

/** The changes that make something else the query; filters and methods stay. */
export function query(given: Partial<SearchValues>): Partial<SearchValues> {
  return { ...OTHER_QUERY, ...given };
}

/** The changes for another scope: its default method where it has not the present one. */
export function scoped(scope: Scope, method: Method): Partial<SearchValues> {
  const methods = METHODS_OF[scope];
  return { scope, method: methods.includes(method) ? method : "fused", hit: "", n: PAGE_SIZE };
}

/** Names a hit in an address: its clip and, of a part of it, the start. */
export function hitKey(hit: Pick<Schemas["Hit"], "clip" | "start">, scope: Scope): string {
  return scope === "clips" ? hit.clip.id : `${hit.clip.id}@${hit.start}`;
}
