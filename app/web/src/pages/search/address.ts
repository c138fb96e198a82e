/** The search page's state in its address, and what it asks the API for. */
import type { Schemas } from "$/api/client";
import { choice, flag, list, number, text, type Values } from "$/core/query";
import { PLAYER } from "$/player/view";
import {
  GROUPS,
  ORDERS,
  arrangementOf,
  type Arrangement,
  type GroupName,
  type Order,
} from "./arrangement";
import { MAX_EXAMPLES, readExample, writeExample, type Example } from "./parts";
import { wordOf } from "./words";

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

/** What people read of the method that an answer names. */
export function titleOfMethod(method: string): string {
  const titles: Readonly<Record<string, string>> = { ...METHODS, ...MODES, pose: "Pose" };
  return titles[method] ?? method;
}

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
  /** Id of the clip that is the query, alone or with the parts below. */
  clip: text(),
  /** Further examples, see `parts.ts`. */
  ex: list(),
  /** Name of the file that is the query; an address cannot hold the file itself. */
  file: text(),
  /** Whether hits must not be like the file. */
  less: flag(),
  /** The part of the clip or the file, seconds. */
  start: number(null, 0, MAX_SECONDS),
  end: number(null, 0, MAX_SECONDS),
  /** The time of the pose of the clip that is the query, seconds; null: its motion is. */
  pose: number(null, 0, MAX_SECONDS),
  method: choice(Object.keys(METHODS) as Method[], "fused"),
  scope: choice(Object.keys(SCOPES) as Scope[], "clips"),
  /** Whether a faster or slower motion is another one. */
  paced: flag(),
  person: list(),
  task: list(),
  word: list(),
  source: list(),
  license: list(),
  /** Labels of clips that are left out. */
  not_person: list(),
  not_task: list(),
  not_word: list(),
  not_source: list(),
  not_license: list(),
  /** Of which groups only the best hit is shown; whether neighbors are unlike; the least score. */
  group_by: choice(Object.keys(GROUPS) as GroupName[], ""),
  diverse: flag(),
  least: number(null, 0, 1),
  /** The order of the hits that are shown. */
  order: choice(Object.keys(ORDERS) as Order[], "best"),
  /** Id of the saved search that this is, and whether only its new hits are shown. */
  saved: text(),
  fresh: flag(),
  n: number(PAGE_SIZE, 1, MAX_HITS),
  /** Key of the hit that is in the player. */
  hit: text(),
  /** Whether each hit shows what each part of the query says. */
  why: flag(),
  /** Id of the hit that is explained. */
  about: text(),
};

export type SearchValues = Values<typeof SEARCH>;

/** Labels by which clips are chosen, or left out. */
export const LABELS = ["person", "task", "word", "source", "license"] as const;
export type LabelName = (typeof LABELS)[number];
export type FilterName = LabelName | `not_${LabelName}`;
export const FILTERS: readonly FilterName[] = [
  ...LABELS,
  ...LABELS.map((name) => `not_${name}` as const),
];

type Filter = Partial<Record<FilterName, readonly string[]>>;
interface Options {
  readonly limit: number;
  readonly filter?: Filter;
}
interface MotionOptions extends Options {
  readonly method: Method;
  readonly scope: Scope;
  readonly tempo?: "same";
  readonly start?: number;
  readonly end?: number;
}
interface WordOptions extends Options {
  readonly words: readonly string[];
  readonly mode: Mode;
  readonly scope?: Scope;
}
interface PartsOptions extends Options, Arrangement {
  readonly examples: readonly ExampleOptions[];
  readonly words: readonly string[];
  readonly method: Method;
  readonly mode: Mode;
  /** Of the file. */
  readonly start?: number;
  readonly end?: number;
  readonly against?: boolean;
}
interface ExampleOptions {
  readonly clip_id: string;
  readonly against: boolean;
  readonly start?: number;
  readonly end?: number;
}
interface PoseOptions extends Options {
  readonly clip_id: string;
  readonly time: number;
}
export type Asked =
  | { readonly kind: "pose"; readonly body: PoseOptions }
  | { readonly kind: "words"; readonly body: WordOptions }
  | { readonly kind: "clip"; readonly body: MotionOptions & { readonly clip_id: string } }
  | { readonly kind: "file"; readonly name: string; readonly body: MotionOptions }
  /** Several parts; name: of the file among them, empty without one. */
  | { readonly kind: "parts"; readonly name: string; readonly body: PartsOptions }
  /** A saved search that the fields of the address cannot say, or its new hits. */
  | { readonly kind: "saved"; readonly id: string; readonly body: { readonly limit: number } }
  | { readonly kind: "fresh"; readonly id: string };

/** What the address asks for; null where it asks for nothing, or where all is against something. */
export function askedFor(values: SearchValues): Asked | null {
  const { saved: id } = values;
  if (id && values.fresh) return { kind: "fresh", id };
  return queryOf(values) ?? (id ? { kind: "saved", id, body: { limit: limitOf(values) } } : null);
}

/** The query of the address without regard to whether it is saved. */
export function queryOf(values: SearchValues): Asked | null {
  if (isPose(values)) {
    return { kind: "pose", body: { clip_id: values.clip, time: values.pose, ...common(values) } };
  }
  const examples = examplesOf(values);
  const [one] = examples;
  const parts = examples.length + (values.file ? 1 : 0) + (values.q.length > 0 ? 1 : 0);
  const isOneOfParts = parts > 1 || (parts === 1 && isArranged(values));
  if (isOneOfParts) return isForSomething(values) ? severalParts(values, examples) : null;
  if (one) {
    return one.isAgainst ? null : { kind: "clip", body: { ...example(one), ...motion(values) } };
  }
  if (values.file) {
    if (values.less) return null;
    const body = { ...partOf(values), ...motion(values) };
    return { kind: "file", name: values.file, body };
  }
  if (values.q.length === 0) return null;
  const { mode } = values;
  const scope = values.scope === "clips" ? {} : { scope: values.scope };
  return { kind: "words", body: { words: [...values.q], mode, ...scope, ...common(values) } };
}

const limitOf = (values: SearchValues): number => values.n ?? PAGE_SIZE;

function isPose(values: SearchValues): values is SearchValues & { pose: number } {
  return values.clip !== "" && values.pose !== null;
}

/** All examples but the file: that of older addresses first. */
export function examplesOf(values: SearchValues): readonly Example[] {
  if (isPose(values)) return [];
  const { clip: id, start, end } = values;
  const first = id ? [{ id, start, end, isAgainst: false }] : [];
  const others = values.ex.map(readExample).filter((one) => one !== null);
  return [...first, ...others].slice(0, MAX_EXAMPLES);
}

/** The changes that give the query these examples; the file keeps its part. */
export function withExamples(
  values: SearchValues,
  examples: readonly Example[],
): Partial<SearchValues> {
  const [one, ...more] = examples;
  const changes = { ...OTHER_HITS, pose: null, ...(values.clip && { start: null, end: null }) };
  const isAlone = one && !one.isAgainst && more.length === 0 && !values.file;
  // What is one motion alone has its own fields: other pages link to them.
  if (isAlone) return { ...changes, clip: one.id, start: one.start, end: one.end, ex: [] };
  return { ...changes, clip: "", ex: examples.map(writeExample) };
}

/** Whether the query has parts, and they are all against something. */
export function isAllAgainst(values: SearchValues): boolean {
  const hasWordsAsPart = values.q.length > 0 && isArranged(values);
  const hasParts = examplesOf(values).length > 0 || values.file !== "" || hasWordsAsPart;
  return hasParts && !isForSomething(values);
}

function isForSomething(values: SearchValues): boolean {
  return (
    (values.file !== "" && !values.less) ||
    examplesOf(values).some(({ isAgainst }) => !isAgainst) ||
    values.q.some((word) => !wordOf(word).isMinus)
  );
}

/** Only whole clips are arranged. */
function isArranged(values: SearchValues): boolean {
  return values.scope === "clips" && Object.keys(arrangementOf(values)).length > 0;
}

function severalParts(values: SearchValues, examples: readonly Example[]): Asked {
  const { q, method, mode, file } = values;
  const body = {
    examples: examples.map((one) => ({ ...example(one), against: one.isAgainst })),
    words: [...q],
    method,
    mode,
    ...(file && { ...partOf(values), against: values.less }),
    ...arrangementOf(values),
    ...common(values),
  };
  return { kind: "parts", name: file, body };
}

function example(one: Example): Omit<ExampleOptions, "against"> {
  return { clip_id: one.id, ...partOf(one) };
}

function partOf({ start, end }: { start: number | null; end: number | null }): {
  start?: number;
  end?: number;
} {
  return { ...(start !== null && { start }), ...(end !== null && { end }) };
}

function motion(values: SearchValues): MotionOptions {
  return {
    method: values.method,
    scope: values.scope,
    ...(values.paced && hasTempo(values) && { tempo: "same" as const }),
    ...common(values),
  };
}

/** Whether the search can tell tempi apart, or not. */
export function hasTempo({ method, scope }: Pick<SearchValues, "method" | "scope">): boolean {
  return method === "fused" && scope === "clips";
}

function common(values: SearchValues): Options {
  const limit = limitOf(values);
  const chosen = FILTERS.filter((name) => values[name].length > 0);
  if (chosen.length === 0) return { limit };
  return { limit, filter: Object.fromEntries(chosen.map((name) => [name, [...values[name]]])) };
}

export function isFiltered(values: SearchValues): boolean {
  return values.least !== null || FILTERS.some((name) => values[name].length > 0);
}

export const UNFILTERED: Partial<SearchValues> = {
  least: null,
  ...Object.fromEntries(FILTERS.map((name) => [name, []])),
};

/** What another query sets: its hits are others. */
const OTHER_HITS: Partial<SearchValues> = {
  fresh: false,
  n: PAGE_SIZE,
  hit: "",
  about: "",
  t: 0,
  from: null,
  to: null,
};

/** A part belongs to one motion. */
const OTHER_QUERY: Partial<SearchValues> = {
  ...OTHER_HITS,
  saved: "",
  q: [],
  clip: "",
  ex: [],
  file: "",
  less: false,
  start: null,
  end: null,
  pose: null,
};

/** The changes that make something else the query; filters and methods stay. */
export function query(given: Partial<SearchValues>): Partial<SearchValues> {
  return { ...OTHER_QUERY, ...given };
}

/** The changes that add words or a file to the query, or take them away. */
export function changed(
  given: Pick<Partial<SearchValues>, "q" | "file" | "less">,
): Partial<SearchValues> {
  return { ...OTHER_HITS, pose: null, ...given };
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
