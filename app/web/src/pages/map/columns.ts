/** The clips of the map, as the API sends them: a column for each thing that is known of them. */
import type { Schemas } from "$/api/client";
import type { Labeled } from "$/pages/gallery/changes";

export type Columns = Schemas["SpaceColumns"];
type Codes = Columns["labels"][string];

interface AnyCodes {
  readonly values: Columns["metadata"][string]["values"];
  readonly codes: readonly number[];
}

const NO_CODES: Codes = { values: [], codes: [] };

/** Person, task, source or license of every clip. */
export function labelOf(columns: Columns, name: string): Codes {
  return columns.labels[name] ?? NO_CODES;
}

/** A key of the metadata of every clip. */
export function metadataOf({ metadata, clip_ids: ids }: Columns, key: string): AnyCodes | null {
  const found = metadata[key];
  if (!found) return null;
  const codes = new Array<number>(ids.length).fill(-1);
  found.clips.forEach((clip, place) => (codes[clip] = found.codes[place] ?? -1));
  return { values: found.values, codes };
}

/** x and y of every clip, one after the other. */
export function pointsOf({ clip_ids: ids, points: [xs = [], ys = []] }: Columns): Float32Array {
  const points = new Float32Array(ids.length * 2);
  for (let index = 0; index < ids.length; index += 1) {
    points[index * 2] = xs[index] ?? 0;
    points[index * 2 + 1] = ys[index] ?? 0;
  }
  return points;
}

/** The columns without some clips. */
export function without(columns: Columns, hidden: ReadonlySet<string>): Columns {
  if (hidden.size === 0) return columns;
  const kept = [...columns.clip_ids.keys()].filter(
    (index) => !hidden.has(columns.clip_ids[index] ?? ""),
  );
  const places = new Map(kept.map((index, place) => [index, place]));
  const of = <T>(column: readonly T[]): T[] => kept.map((index) => column[index] as T);
  const coded = <T extends { codes: number[] }>(one: T): T => ({ ...one, codes: of(one.codes) });
  const each = <T>(some: Record<string, T>, change: (one: T) => T): Record<string, T> =>
    Object.fromEntries(Object.entries(some).map(([name, one]) => [name, change(one)]));
  return {
    ...columns,
    clip_ids: of(columns.clip_ids),
    points: columns.points.map(of),
    labels: each(columns.labels, coded),
    words: coded(columns.words),
    measures: each(columns.measures, of),
    metadata: each(columns.metadata, ({ values, clips, codes }) => {
      const left = clips.map((clip) => places.get(clip) ?? -1);
      const isLeft = (_: unknown, place: number): boolean => (left[place] ?? -1) >= 0;
      return { values, clips: left.filter(isLeft), codes: codes.filter(isLeft) };
    }),
  };
}

/** What is known of some clips, to label them. */
export function labeled(columns: Columns, indices: readonly number[]): Labeled[] {
  const label = (name: string, index: number): string | null => {
    const { values, codes } = labelOf(columns, name);
    return values[codes[index] ?? -1] ?? null;
  };
  return indices.map((index) => ({
    id: columns.clip_ids[index] ?? "",
    person: label("person", index),
    task: label("task", index),
    words: columns.words.values[columns.words.codes[index] ?? -1] ?? [],
  }));
}
