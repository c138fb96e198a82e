/** How many of the hits carry which label. */
import type { Schemas } from "$/api/client";
import { LABELS, type LabelName, type SearchValues } from "./address";

export type Labeled = Pick<Schemas["Clip"], "person" | "task" | "words" | "source" | "license">;

export interface FacetValue {
  readonly value: string;
  readonly count: number;
  /** Whether only its clips are asked for, or they are left out. */
  readonly state: "only" | "without" | "free";
}

export interface Facet {
  readonly name: LabelName;
  readonly values: readonly FacetValue[];
}

/** Fields of a clip that facets count, as the API names them. */
export const FACET_FIELDS = ["id", "person", "task", "words", "source", "license"].map(
  (name) => `clip.${name}`,
);

const MAX_VALUES = 8;

/** How often each value of a label is met. */
export type Counts = Readonly<Record<LabelName, ReadonlyMap<string, number>>>;

export interface Counted {
  /** Number of clips that are counted. */
  readonly count: number;
  readonly counts: Counts;
  /** Which hits: those that are likely, all, or the best ones. */
  readonly of: "likely" | "all" | "best";
}

/** As the API counts them over all hits. */
export function countsOfFacets(
  facets: Readonly<Record<string, Schemas["Facet"]>>,
): Omit<Counted, "of"> {
  const { values = [], others = 0, missing = 0 } = facets.person ?? {};
  // A clip has one person, or none.
  const count = values.reduce((total, one) => total + one.count, others + missing);
  const counts = countsBy(
    (name) => new Map((facets[name]?.values ?? []).map(({ value, count }) => [value, count])),
  );
  return { count, counts };
}

export function countsOfClips(clips: readonly Labeled[]): Omit<Counted, "of"> {
  const counts = countsBy((name) => {
    const found = new Map<string, number>();
    for (const clip of clips) {
      for (const value of valuesOf(clip, name)) found.set(value, (found.get(value) ?? 0) + 1);
    }
    return found;
  });
  return { count: clips.length, counts };
}

function countsBy(of: (name: LabelName) => ReadonlyMap<string, number>): Counts {
  return Object.fromEntries(LABELS.map((name) => [name, of(name)])) as Record<
    LabelName,
    ReadonlyMap<string, number>
  >;
}

/**
 * The facets of hits: of each label its most frequent values. What is chosen or left out is there
 * too, so that it can be taken back. A label of which there is nothing to choose is left out.
 */
export function facetsOf(
  labels: Counts,
  chosen: Pick<SearchValues, LabelName | `not_${LabelName}`>,
): readonly Facet[] {
  return LABELS.flatMap((name) => {
    const counts = labels[name];
    const [only, without] = [chosen[name], chosen[`not_${name}`]];
    const frequent = [...counts]
      .sort(([a, one], [b, other]) => other - one || a.localeCompare(b))
      .map(([value]) => value)
      .slice(0, MAX_VALUES);
    const shown = [...new Set([...only, ...without, ...frequent])];
    const isOfUse = shown.length > 1 || only.length + without.length > 0;
    if (!isOfUse) return [];
    const values = shown.map((value): FacetValue => {
      const state = only.includes(value) ? "only" : without.includes(value) ? "without" : "free";
      return { value, count: counts.get(value) ?? 0, state };
    });
    return [{ name, values }];
  });
}

function valuesOf(clip: Labeled, name: LabelName): readonly string[] {
  if (name === "word") return clip.words;
  const value = clip[name];
  return value === null ? [] : [value];
}

/** The changes that give a value of a facet a state; the same state again makes it free. */
export function toggled(
  chosen: Pick<SearchValues, LabelName | `not_${LabelName}`>,
  name: LabelName,
  { value, state }: Pick<FacetValue, "value" | "state">,
  wanted: "only" | "without",
): Partial<SearchValues> {
  const free = (values: readonly string[]): readonly string[] =>
    values.filter((other) => other !== value);
  const changes = { [name]: free(chosen[name]), [`not_${name}`]: free(chosen[`not_${name}`]) };
  if (state === wanted) return changes;
  const field = wanted === "only" ? name : (`not_${name}` as const);
  return { ...changes, [field]: [...free(chosen[field]), value] };
}
