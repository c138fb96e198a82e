/** The kinds of evaluations and their options, in words. */
import type { Schemas } from "$/api/client";

export type Kind = Schemas["EvaluationKind"];
export type Options = Omit<Schemas["NewEvaluation"], "kind">;

interface KindText {
  readonly title: string;
  /** What it measures, in one or two sentences. */
  readonly says: string;
  /** What it needs, and how long it takes. */
  readonly needs: string;
}

export const KINDS: Readonly<Record<Kind, KindText>> = {
  recognition: {
    title: "Recognition",
    says: "How often are persons and tasks recognized that the method has not seen, and how often is somebody new called new?",
    needs:
      "Needs clips with persons and tasks. About a minute for 150 clips; more clips, persons and tasks take longer.",
  },
  retrieval: {
    title: "Search by example",
    says: "Each labeled clip searches for the others of its task. How many of the nearest clips are right?",
    needs:
      "Needs clips with tasks. About a minute for 150 clips; more clips take longer, up to 1,000 queries.",
  },
  words: {
    title: "Words",
    says: "How well are words guessed for clips, and clips found for words?",
    needs:
      "Needs clips with words. About 15 seconds for 150 clips; at most 1,000 clips are judged.",
  },
  keyposes: {
    title: "Keyposes",
    says: "Are the keyposes that Kinedex finds those that people named?",
    needs: "Needs clips whose keyposes were named (by a manifest or the API). Seconds.",
  },
  "low-dimensional": {
    title: "Few dimensions",
    says: "How far is a motion of few dimensions from the real one, if it is made of its keyposes, or of uniform poses?",
    needs: "Needs no labels. About 10 seconds for 150 clips; more clips take longer.",
  },
  symbols: {
    title: "Symbol space",
    says: "How well do distances in the space of motion symbols agree with the differences of the motions?",
    needs: "Needs no labels. Some seconds; at most 200 clips are compared.",
  },
};
export const KIND_NAMES = Object.keys(KINDS) as Kind[];

export const GROUPS = {
  none: "no groups",
  person: "person",
  task: "task",
  source: "source",
  folder: "folder",
  license: "license",
  format: "format",
} as const;
export type Group = keyof typeof GROUPS;

const RECOGNIZERS = [
  "default",
  "multilinear",
  "signatures",
  "pca",
  "perera",
  "mean-motion",
  "prior",
] as const;
const SEARCHES = ["fused", "vector", "dtw", "msv-dtw", "msv-xcorr"] as const;
const METHODS: Readonly<Partial<Record<Kind, readonly string[]>>> = {
  recognition: RECOGNIZERS,
  retrieval: SEARCHES,
};
/** The methods that a kind can judge; none where there is no choice. */
export const methodsOf = (kind: Kind): readonly string[] => METHODS[kind] ?? [];

/** The options as they are in the address: empty or null where the default is meant. */
export interface Form {
  readonly folder: string;
  readonly by: Group;
  readonly method: readonly string[];
  readonly rate: number | null;
  readonly nearest: number | null;
  readonly queries: number | null;
  readonly tolerance: number | null;
}

const HAS: Readonly<Record<keyof Form, readonly Kind[]>> = {
  folder: KIND_NAMES,
  by: ["recognition", "retrieval", "keyposes"],
  method: ["recognition", "retrieval"],
  rate: ["recognition"],
  nearest: ["retrieval"],
  queries: ["retrieval"],
  tolerance: ["keyposes"],
};
export const has = (kind: Kind, option: keyof Form): boolean => HAS[option].includes(kind);

/** The body that starts an evaluation; options of other kinds are left out. */
export function bodyOf(kind: Kind, form: Form): { kind: Kind } & Partial<Options> {
  const methods = form.method.filter((name) => methodsOf(kind).includes(name));
  const own = <T>(option: keyof Form, value: T | null): T | null =>
    has(kind, option) ? value : null;
  const sent = {
    filter: form.folder ? { folder: form.folder } : null,
    by: own("by", form.by === "none" ? null : form.by),
    methods: methods.length > 0 ? methods : null,
    false_accept_rate: own("rate", form.rate),
    k: own("nearest", form.nearest),
    max_queries: own("queries", form.queries),
    tolerance: own("tolerance", form.tolerance),
  };
  const given = Object.entries(sent).filter(([, value]) => value !== null);
  return { kind, ...(Object.fromEntries(given) as Partial<Options>) };
}

/** Options as one line: `by task, methods fused dtw`. */
export function optionsText(options: Readonly<Record<string, unknown>>): string {
  const text = (value: unknown): string => {
    if (Array.isArray(value)) return value.map(text).join(" ");
    if (typeof value === "object" && value !== null)
      return Object.entries(value)
        .map(([name, one]) => `${name} ${text(one)}`)
        .join(", ");
    return String(value);
  };
  return Object.entries(options)
    .map(([name, value]) => `${name.replaceAll("_", " ")}: ${text(value)}`)
    .join("; ");
}
