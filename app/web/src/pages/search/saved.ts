/** Saved searches: what the API keeps of the page's query, and the page's address of what it keeps. */
import type { Schemas } from "$/api/client";
import {
  FILTERS,
  METHODS,
  MODES,
  PAGE_SIZE,
  type Asked,
  type FilterName,
  type Method,
  type Mode,
  type SearchValues,
} from "./address";
import { DIVERSITY, type GroupName } from "./arrangement";
import { writeExample, type Example } from "./parts";

export type Kept = Record<string, unknown>;

/** The most hits that a saved search follows. */
const FOLLOWED = 100;

/**
 * The query as a saved search has it; null where it cannot be saved: poses, parts of clips and files
 * are no composed query.
 */
export function keptOf(asked: Asked | null): Kept | null {
  if (!asked) return null;
  if (asked.kind === "words" && !asked.body.scope) return { ...asked.body, limit: FOLLOWED };
  if (asked.kind === "parts" && !asked.name) return { ...asked.body, limit: FOLLOWED };
  if (asked.kind !== "clip" || asked.body.scope !== "clips" || asked.body.tempo) return null;
  const { clip_id, start, end, method, filter } = asked.body;
  const example = {
    clip_id,
    ...(start !== undefined && { start }),
    ...(end !== undefined && { end }),
  };
  return { examples: [example], method, ...(filter && { filter }), limit: FOLLOWED };
}

/** What the page can say of a query that is kept, written the same way for all; else null. */
export function valuesOf(query: Kept): Partial<SearchValues> | null {
  const { examples = [], words = [], filter, method, mode, limit, ...unread } = query;
  const { group_by, diversity, min_score, ...others } = unread;
  const parts = (examples as Schemas["SearchExample"][]).map(exampleOf);
  const filters = filtersOf((filter ?? {}) as Kept);
  void limit;
  const isUnknown = Object.values(others).some((value) => value !== null && value !== false);
  const isOurs = !diversity || diversity === DIVERSITY;
  if (isUnknown || !isOurs || filters === null || parts.some((part) => part === null)) return null;
  return {
    ex: (parts as Example[]).map(writeExample),
    q: words as readonly string[],
    ...filters,
    group_by: (group_by ?? "") as GroupName,
    diverse: diversity === DIVERSITY,
    least: (min_score as number | undefined) || null,
    method: String(method ?? "fused") in METHODS ? ((method ?? "fused") as Method) : "fused",
    mode: String(mode ?? "default") in MODES ? ((mode ?? "default") as Mode) : "default",
    n: PAGE_SIZE,
  };
}

function exampleOf(example: Schemas["SearchExample"]): Example | null {
  const { clip_id: id, start, end, weight, against } = example;
  if ((weight ?? 1) !== 1 || !id) return null;
  return { id, start: start ?? null, end: end ?? null, isAgainst: against ?? false };
}

function filtersOf(filter: Kept): Partial<SearchValues> | null {
  const given = Object.entries(filter).filter(([, value]) => value !== null);
  if (!given.every(([name]) => FILTERS.includes(name as FilterName))) return null;
  return Object.fromEntries(
    given.map(([name, value]) => [name, Array.isArray(value) ? value : [String(value)]]),
  );
}

/** Whether two queries ask for the same. */
export function isSameQuery(one: Kept, other: Kept): boolean {
  const [a, b] = [valuesOf(one), valuesOf(other)];
  return a !== null && b !== null && JSON.stringify(sorted(a)) === JSON.stringify(sorted(b));
}

function sorted(values: object): readonly [string, unknown][] {
  return Object.entries(values).sort(([one], [other]) => one.localeCompare(other));
}
