/** The gallery's state in its address, and what it asks the API for. */
import { choice, list, number, text, type Values } from "$/core/query";
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

const MAX_SECONDS = 1e6;

export const GALLERY = {
  q: text(),
  person: list(),
  task: list(),
  word: list(),
  source: list(),
  license: list(),
  state: choice(["any", ...STATES], "any"),
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
  if (values.state !== "any") query.state = values.state;
  if (values.min !== null) query.min_duration = values.min;
  if (values.max !== null) query.max_duration = values.max;
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
  state: "any",
  min: null,
  max: null,
};

export function isFiltered(values: GalleryValues): boolean {
  return Object.keys(clipQuery(values)).length > 1;
}
