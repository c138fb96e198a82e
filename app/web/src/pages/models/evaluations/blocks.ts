/** What the results of an evaluation are shown as: tables, plots, matrices and remarks. */
export type Point = readonly [x: number, y: number];
export type Unit = "text" | "share" | "count" | "mm" | "number";
export type Cell = string | number | null;

export interface Column {
  readonly name: string;
  readonly unit: Unit;
}

export interface TableBlock {
  readonly type: "table";
  readonly title: string;
  readonly note?: string;
  readonly columns: readonly Column[];
  readonly rows: readonly (readonly Cell[])[];
  /** The clip of each row, where rows are clips. */
  readonly clipIds?: readonly string[];
}

export interface Line {
  readonly name: string;
  readonly points: readonly Point[];
}

export interface PlotBlock {
  readonly type: "plot";
  readonly title: string;
  readonly note?: string;
  readonly x: string;
  readonly y: string;
  readonly lines: readonly Line[];
  /** Of y; else as far as the points go. */
  readonly range?: readonly [least: number, most: number];
  readonly isLog?: boolean;
}

export interface MatrixBlock {
  readonly type: "matrix";
  readonly title: string;
  readonly note?: string;
  /** The gallery's filter of the labels. */
  readonly filter: "person" | "task";
  readonly labels: readonly string[];
  /** A row for each true label; a row's shares sum to 1. */
  readonly shares: readonly (readonly number[])[];
}

export interface RemarkBlock {
  readonly type: "remarks";
  readonly title: string;
  readonly lines: readonly string[];
}

export type Block = TableBlock | PlotBlock | MatrixBlock | RemarkBlock;

export const column = (name: string, unit: Unit): Column => ({ name, unit });
export const shares = (...names: readonly string[]): readonly Column[] =>
  names.map((name) => column(name, "share"));

/** A value as people read it. */
export function shown(value: Cell, unit: Unit): string {
  if (value === null) return "–";
  if (typeof value === "string") return value;
  if (unit === "share") return `${(value * 100).toFixed(1)} %`;
  if (unit === "mm") return `${value.toFixed(1)} mm`;
  if (unit === "count") return new Intl.NumberFormat("en-US").format(value);
  return value !== 0 && Math.abs(value) < 0.001 ? value.toExponential(1) : value.toFixed(3);
}

/** A change as people read it, with its sign: a share in percentage points. */
export function changeShown(now: number, before: number, unit: Unit): string {
  const change = now - before;
  const sign = change < 0 ? "−" : "+";
  const size = Math.abs(change);
  if (unit === "share")
    return size < 0.0005 ? "the same" : `${sign}${(size * 100).toFixed(1)} points`;
  const text = shown(size, unit);
  return text === shown(0, unit) ? "the same" : `${sign}${text}`;
}
