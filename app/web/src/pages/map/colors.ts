/** Which color each clip of the map gets from a label, a measure or its metadata. */
import { MEASURE_NAMES, titleOf } from "$/motion/measures";
import { labelOf, metadataOf, type Columns } from "./columns";

export const LABELS = {
  task: "Task",
  person: "Person",
  word: "Word",
  source: "Source",
  license: "License",
} as const;
const META = "meta.";

/** Colors that are told apart; the rarer values share one. */
export const MAX_CLASSES = 10;
export const OTHER = MAX_CLASSES;
export const NONE = MAX_CLASSES + 1;

/** Each clip is of a class: a value, one of the OTHER values, or NONE. */
export interface Classes {
  readonly kind: "classes";
  readonly of: Uint8Array;
  readonly classes: readonly { readonly value: string; readonly count: number }[];
  readonly others: number;
  readonly none: number;
}

/** Each clip has a number, 0 for the least and 1 for the most; NaN where there is none. */
export interface Range {
  readonly kind: "range";
  readonly of: Float32Array;
  readonly least: number;
  readonly most: number;
}

/** What the points can be colored by: names for the address, with titles. */
export function choices({ metadata }: Columns): readonly (readonly [string, string])[] {
  const own = Object.keys(metadata)
    .sort()
    .map((key) => [META + key, key] as const);
  const measures = MEASURE_NAMES.map((name) => [name, titleOf(name)] as const);
  return [...Object.entries(LABELS), ...measures, ...own];
}

export function coloring(columns: Columns, by: string): Classes | Range {
  const measured = columns.measures[by];
  if (measured) return ranged(measured);
  if (by === "word") return classed(commonWords(columns));
  const key = by.startsWith(META) ? by.slice(META.length) : "";
  const { values, codes } = metadataOf(columns, key) ?? labelOf(columns, by);
  const areNumbers = values.length > 0 && values.every((value) => typeof value === "number");
  if (areNumbers) return ranged(codes.map((code) => (values[code] as number | undefined) ?? null));
  const count = columns.clip_ids.length;
  const all = codes.length === count ? codes : new Array<number>(count).fill(-1);
  return classed({ values: values.map(String), codes: all });
}

interface Coded {
  readonly values: readonly string[];
  /** For each clip the place of its value in `values`; -1 without one. */
  readonly codes: readonly number[];
}

/** Of each clip's words the one that most clips carry. */
function commonWords({ words: { values: sets, codes } }: Columns): Coded {
  const often = counted(codes, sets.length);
  const counts = new Map<string, number>();
  sets.forEach((words, set) => {
    for (const word of words) counts.set(word, (counts.get(word) ?? 0) + (often[set] ?? 0));
  });
  const values = [...counts.keys()];
  const places = new Map(values.map((word, place) => [word, place]));
  const common = sets.map((words) =>
    words.reduce(
      (best, word) =>
        best < 0 || (counts.get(word) ?? 0) > (counts.get(values[best] ?? "") ?? 0)
          ? (places.get(word) ?? -1)
          : best,
      -1,
    ),
  );
  return { values, codes: codes.map((set) => common[set] ?? -1) };
}

/** How many clips have each code. */
function counted(codes: readonly number[], size: number): Uint32Array {
  const counts = new Uint32Array(size);
  for (const code of codes) if (code >= 0) counts[code] = (counts[code] ?? 0) + 1;
  return counts;
}

function classed({ values, codes }: Coded): Classes {
  const counts = counted(codes, values.length);
  const byCount = values
    .map((value, code) => ({ value, code, count: counts[code] ?? 0 }))
    .filter(({ count }) => count > 0)
    .sort((one, other) => other.count - one.count || one.value.localeCompare(other.value));
  const classes = byCount.slice(0, MAX_CLASSES);
  const places = new Uint8Array(values.length).fill(OTHER);
  classes.forEach(({ code }, place) => (places[code] = place));
  return {
    kind: "classes",
    of: Uint8Array.from(codes, (code) => places[code] ?? NONE),
    classes: classes.map(({ value, count }) => ({ value, count })),
    others: byCount.slice(MAX_CLASSES).reduce((sum, { count }) => sum + count, 0),
    none: codes.length - counts.reduce((sum, count) => sum + count, 0),
  };
}

function ranged(values: readonly (number | null)[]): Range {
  let [least, most] = [Infinity, -Infinity];
  for (const value of values) {
    if (value === null) continue;
    least = Math.min(least, value);
    most = Math.max(most, value);
  }
  const of = Float32Array.from(values, (value) =>
    value === null ? NaN : (value - least) / (most - least || 1),
  );
  return { kind: "range", of, least, most };
}

/** Indices of the clips of a class, by its name in an address. */
export function ofClass(colors: Classes | Range, value: string): number[] {
  if (colors.kind === "range" || value === "") return [];
  const place = colors.classes.findIndex((one) => one.value === value);
  return place < 0 ? [] : [...colors.of.keys()].filter((index) => colors.of[index] === place);
}
