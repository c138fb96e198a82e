/** Held-out figures as the service gives them, made ready to show. */
import type { Schemas } from "$/api/client";

type Model = Schemas["Model"];
export type Point = readonly [x: number, y: number];

export interface Row {
  readonly method: string;
  readonly values: readonly (number | null)[];
}

export interface Table {
  readonly columns: readonly string[];
  readonly rows: readonly Row[];
}

/** The name of our own method: its row stands out. */
export const OURS = "Kinedex";

const METHODS: Readonly<Record<string, string>> = {
  default: OURS,
  multilinear: "Multilinear (Vasilescu)",
  perera: "Weighted distances (Perera)",
  signatures: "Signatures (Vasilescu)",
  pca: "Flat PCA",
  "mean-motion": "Mean motion",
  prior: "Always the most frequent",
  cca: "Correlated space (Takano)",
  "cca-score": "Correlated space, by score",
  "cca-distance": "Correlated space, by distance",
  "cca-10": "Correlated space, 10 dimensions",
  printed: "Correlated space, as printed",
  "cca-symbol": "Correlated space, symbol to symbol",
};

export const methodName = (method: string): string => METHODS[method] ?? method;

type Shares = Record<string, Record<string, number>>;

/** Shares of clips that are recognized rightly, by method. */
export function recognitionTable(model: Model): Table {
  const shares = (model.figures.held_out ?? {}) as Shares;
  const rows = Object.entries(shares).map(([method, of]) => ({
    method: methodName(method),
    values: [of.person ?? null, of.task ?? null, of.both ?? null],
  }));
  return { columns: ["Person", "Task", "Both"], rows };
}

/** Figures of the word models, by method. */
export function wordTable(model: Model): Table {
  const figures = (model.figures.figures ?? []) as Record<string, number | string>[];
  const names = ["top_3_recognition", "word_map", "word_f", "set_map"];
  const value = (found: unknown): number | null => (typeof found === "number" ? found : null);
  return {
    columns: ["In the best 3", "Words, MAP", "Words, F", "Sets, MAP"],
    rows: figures.map((row) => ({
      method: methodName(String(row.method)),
      values: names.map((name) => value(row[name])),
    })),
  };
}

/** False acceptance and false rejection at each threshold, by false acceptance. */
export function errorCurve(model: Model, factor: "person" | "task"): readonly Point[] {
  const unknown = (model.figures.unknown ?? {}) as Record<string, { curve?: unknown } | undefined>;
  const curve = (unknown[factor]?.curve ?? []) as Record<string, number>[];
  return curve
    .map((point): Point => [point.false_acceptance ?? 0, point.false_rejection ?? 0])
    .toSorted(([one], [other]) => one - other);
}

export interface Cell {
  readonly label: string;
  readonly guess: string;
  readonly count: number;
  /** Of the clips with the label. */
  readonly share: number;
}

/** Rows and columns of a confusion matrix: for each label what its clips were taken for. */
export function matrixOf({ names, items }: Schemas["Confusion"]): readonly (readonly Cell[])[] {
  const counts = new Map(items.map((cell) => [`${cell.label}\n${cell.guess}`, cell.count]));
  return names.map((label) => {
    const row = names.map((guess) => counts.get(`${label}\n${guess}`) ?? 0);
    const whole = row.reduce((sum, count) => sum + count, 0);
    return names.map((guess, place) => {
      const count = row[place] ?? 0;
      return { label, guess, count, share: whole > 0 ? count / whole : 0 };
    });
  });
}

/** The confusions, the most frequent first. */
export function largestConfusions(matrix: readonly (readonly Cell[])[], most: number) {
  return matrix
    .flat()
    .filter(({ label, guess, count }) => label !== guess && count > 0)
    .toSorted((one, other) => other.count - one.count)
    .slice(0, most);
}

/** Points as the path of a line in a square of the given size; y goes up. */
export function linePath(points: readonly Point[], size: number): string {
  const steps = points.map(([x, y]) => `${(x * size).toFixed(1)} ${((1 - y) * size).toFixed(1)}`);
  return steps.length > 0 ? `M${steps.join("L")}` : "";
}
