/** Which color each clip of the map gets from a label, a measure or its metadata. */
import type { Schemas } from "$/api/client";
import { MEASURE_NAMES, titleOf } from "$/motion/measures";

export type MapClip = Schemas["MapPoint"];
type Value = string | number | boolean | null;

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
export function choices(clips: readonly MapClip[]): readonly (readonly [string, string])[] {
  const keys = new Set(clips.flatMap(({ metadata }) => Object.keys(metadata)));
  const own = [...keys].sort().map((key) => [META + key, key] as const);
  const measures = MEASURE_NAMES.map((name) => [name, titleOf(name)] as const);
  return [...Object.entries(LABELS), ...measures, ...own];
}

export function coloring(clips: readonly MapClip[], by: string): Classes | Range {
  const values = by === "word" ? commonWords(clips) : clips.map((clip) => valueOf(clip, by));
  const numbers = values.filter((value) => value !== null);
  const areNumbers = numbers.length > 0 && numbers.every((value) => typeof value === "number");
  return areNumbers ? ranged(values as (number | null)[]) : classed(values);
}

function valueOf(clip: MapClip, by: string): Value {
  if (by.startsWith(META)) return clip.metadata[by.slice(META.length)] ?? null;
  if (by === "person" || by === "task" || by === "source" || by === "license") return clip[by];
  const measure = MEASURE_NAMES.find((name) => name === by);
  return measure ? clip[measure] : null;
}

/** Of each clip's words the one that most clips carry. */
function commonWords(clips: readonly MapClip[]): (string | null)[] {
  const counts = counted(clips.flatMap(({ words }) => words));
  const often = (word: string): number => counts.get(word) ?? 0;
  return clips.map(({ words }) =>
    words.reduce<string | null>(
      (best, word) => (best === null || often(word) > often(best) ? word : best),
      null,
    ),
  );
}

function counted(values: readonly string[]): Map<string, number> {
  const counts = new Map<string, number>();
  for (const value of values) counts.set(value, (counts.get(value) ?? 0) + 1);
  return counts;
}

function classed(values: readonly Value[]): Classes {
  const texts = values.map((value) => (value === null ? null : String(value)));
  const counts = counted(texts.filter((text) => text !== null));
  const byCount = [...counts].toSorted(
    ([one, many], [other, few]) => few - many || one.localeCompare(other),
  );
  const classes = byCount.slice(0, MAX_CLASSES).map(([value, count]) => ({ value, count }));
  const places = new Map(classes.map(({ value }, place) => [value, place]));
  const of = Uint8Array.from(texts, (text) => (text === null ? NONE : (places.get(text) ?? OTHER)));
  const others = byCount.slice(MAX_CLASSES).reduce((sum, [, count]) => sum + count, 0);
  return {
    kind: "classes",
    of,
    classes,
    others,
    none: texts.filter((text) => text === null).length,
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
