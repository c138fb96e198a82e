/** The gallery's state in its address, and what it asks the API for. */
import { choice, flag, list, number, text, type Field, type Values } from "$/core/query";
import { MEASURE_NAMES, type Measure } from "$/motion/measures";
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
  "-speed": "Fastest first",
  speed: "Slowest first",
  "-travel": "Farthest first",
  "-energy": "Most energy first",
  energy: "Least energy first",
  "-tempo": "Highest tempo first",
  "-frame_rate": "Highest frame rate first",
  "-joints": "Most joints first",
} as const;
/** One of these, or any measure of the library with or without a minus. */
export type Sort = keyof typeof SORTS | (string & {});

const ORDER = /^-?[a-z_]{1,40}$/;
const order: Field<Sort> = {
  initial: "-created_at",
  read: ([first]) => (first !== undefined && ORDER.test(first) ? first : undefined),
  write: (value) => [value],
};

export const SIZES = { s: "Small", m: "Medium", l: "Large" } as const;
export type Size = keyof typeof SIZES;

export const STATES = ["ready", "processing", "queued", "failed"] as const;

/** Labels that a clip may lack. */
export const LACKS = ["person", "task", "words"] as const;

const MAX = 1e6;

type Other = Exclude<Measure, "duration">;
type BoundName = "min" | "max" | `${Other}_${"min" | "max"}`;

/** The fields of the least and the largest value of a measure. */
export function boundsOf(measure: Measure): readonly [BoundName, BoundName] {
  return measure === "duration" ? ["min", "max"] : [`${measure}_min`, `${measure}_max`];
}

const BOUND_NAMES = MEASURE_NAMES.flatMap(boundsOf);
const BOUNDS = Object.fromEntries(
  BOUND_NAMES.map((name) => [name, number(null, 0, MAX)]),
) as Record<BoundName, Field<number | null>>;

export const GALLERY = {
  q: text(),
  person: list(),
  task: list(),
  word: list(),
  source: list(),
  license: list(),
  /** Ids of collections: clips of any of them. */
  collection: list(),
  /** Metadata, each as KEY=VALUE. */
  meta: list(),
  state: choice(["any", ...STATES], "any"),
  /** A label that the clips lack. */
  lacks: choice(["nothing", ...LACKS], "nothing"),
  /** Only clips with warnings. */
  doubts: flag(),
  ...BOUNDS,
  /** Bounds of other measures, each as NAME:LEAST:LARGEST, of which one may be left out. */
  measure: list(),
  sort: order,
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
  if (values.collection.length > 0) query.collection = [...values.collection];
  Object.assign(query, metadataQuery(values.meta));
  if (values.state !== "any") query.state = values.state;
  if (values.lacks !== "nothing") query.missing = [values.lacks];
  if (values.doubts) query.has_warnings = true;
  Object.assign(query, measuresQuery(values), otherBounds(values.measure));
  return query;
}

function measuresQuery(values: GalleryValues): Record<string, number> {
  const query: Record<string, number> = {};
  for (const measure of MEASURE_NAMES) {
    const [least, most] = boundsOf(measure).map((name) => values[name]);
    if (typeof least === "number") query[`min_${measure}`] = least;
    if (typeof most === "number") query[`max_${measure}`] = most;
  }
  return query;
}

export interface Bounds {
  readonly name: string;
  readonly least: number | null;
  readonly largest: number | null;
}

/** NAME:LEAST:LARGEST as bounds; null where it cannot be read. */
export function readBounds(written: string): Bounds | null {
  const [name = "", least = "", largest = ""] = written.split(":");
  const bound = (text: string): number | null =>
    text !== "" && Number.isFinite(Number(text)) ? Number(text) : null;
  const bounds = { name, least: bound(least), largest: bound(largest) };
  const isRead = ORDER.test(name) && (bounds.least !== null || bounds.largest !== null);
  return isRead ? bounds : null;
}

/** With other bounds of one measure; with none it is not asked for. */
export function withBounds(written: readonly string[], bounds: Bounds): readonly string[] {
  const others = written.filter((one) => readBounds(one)?.name !== bounds.name);
  const { name, least, largest } = bounds;
  if (least === null && largest === null) return others;
  return [...others, `${name}:${least ?? ""}:${largest ?? ""}`];
}

function otherBounds(written: readonly string[]): Record<string, number> {
  const query: Record<string, number> = {};
  for (const { name, least, largest } of written.map(readBounds).filter((one) => one !== null)) {
    if (least !== null) query[`measure.${name}.min`] = least;
    if (largest !== null) query[`measure.${name}.max`] = largest;
  }
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
  collection: [],
  meta: [],
  measure: [],
  state: "any",
  lacks: "nothing",
  doubts: false,
  ...Object.fromEntries(BOUND_NAMES.map((name) => [name, null])),
};

export function isFiltered(values: GalleryValues): boolean {
  return Object.keys(clipQuery(values)).length > 1;
}
