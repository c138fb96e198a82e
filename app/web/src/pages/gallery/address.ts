/** The gallery's state in its address, and what it asks the API for. */
import { choice, flag, list, number, text, type Values } from "$/core/query";
import type { operations } from "$/api/schema";

export const SORTS = {
  "-created_at": "Newest first",
  created_at: "Oldest first",
  name: "Name",
  "-name": "Name, Z to A",
  person: "Person",
  task: "Task",
  "-duration": "Longest first",
  duration: "Shortest first",
} as const;
export type Sort = keyof typeof SORTS;

export const SIZES = { s: "Small", m: "Medium", l: "Large" } as const;
export type Size = keyof typeof SIZES;

export const STATES = ["ready", "processing", "queued", "failed"] as const;

/** Labels that a clip may lack. */
export const LACKS = ["person", "task", "words"] as const;

/** The key of the metadata that names a clip's collection. */
export const COLLECTION = "collection";

const MAX_SECONDS = 1e6;

export const GALLERY = {
  q: text(),
  person: list(),
  task: list(),
  word: list(),
  source: list(),
  license: list(),
  /** Metadata, each as KEY=VALUE. */
  meta: list(),
  state: choice(["any", ...STATES], "any"),
  /** A label that the clips lack. */
  lacks: choice(["nothing", ...LACKS], "nothing"),
  /** Only clips with warnings. */
  doubts: flag(),
  min: number(null, 0, MAX_SECONDS),
  max: number(null, 0, MAX_SECONDS),
  sort: choice(Object.keys(SORTS) as Sort[], "-created_at"),
  size: choice(Object.keys(SIZES) as Size[], "m"),
  /** Ids of the chosen clips, as far as an address may hold them. */
  sel: list(),
};

export type GalleryValues = Values<typeof GALLERY>;
export type ClipQuery = NonNullable<operations["list_clips"]["parameters"]["query"]>;

export const LABELS = ["person", "task", "word", "source", "license"] as const;
export type LabelName = (typeof LABELS)[number];

/** The filters and the order as the API takes them. */
export function clipQuery(values: GalleryValues): ClipQuery {
  const query: ClipQuery = { sort: values.sort };
  if (values.q.trim()) query.q = values.q.trim();
  for (const name of LABELS) {
    if (values[name].length > 0) query[name] = [...values[name]];
  }
  Object.assign(query, metadataQuery(values.meta));
  if (values.state !== "any") query.state = values.state;
  if (values.lacks !== "nothing") query.missing = [values.lacks];
  if (values.doubts) query.has_warnings = true;
  if (values.min !== null) query.min_duration = values.min;
  if (values.max !== null) query.max_duration = values.max;
  return query;
}

/** KEY=VALUE as its two parts; a value may hold an equals sign. */
export function metadataParts(written: string): readonly [key: string, value: string] {
  const at = written.indexOf("=");
  return at < 0 ? [written, ""] : [written.slice(0, at), written.slice(at + 1)];
}

/** The API takes each key as a parameter of its own. */
function metadataQuery(written: readonly string[]): Record<string, string[]> {
  const query: Record<string, string[]> = {};
  for (const [key, value] of written.map(metadataParts)) (query[`meta.${key}`] ??= []).push(value);
  return query;
}

/** Values that filter nothing: what "clear all" sets. */
export const UNFILTERED: Partial<GalleryValues> = {
  q: "",
  person: [],
  task: [],
  word: [],
  source: [],
  license: [],
  meta: [],
  state: "any",
  lacks: "nothing",
  doubts: false,
  min: null,
  max: null,
};

export function isFiltered(values: GalleryValues): boolean {
  return Object.keys(clipQuery(values)).length > 1;
}
