/** What a collection covers, as a grid of speeds by turns. */
import type { Schemas } from "$/api/client";

type Cell = Schemas["CoverageCell"];

export interface Covered {
  /** rare: the library has hardly any, either. */
  readonly state: "covered" | "missing" | "rare";
  readonly seconds: number;
  readonly library: number;
}

export interface Grid {
  /** Ranges of turns, degrees per second, from the right to the left. */
  readonly turns: readonly string[];
  readonly rows: readonly {
    /** Range of speeds, meters per second. */
    readonly speed: string;
    /** By turn; null where neither the collection nor the library moves so. */
    readonly cells: readonly (Covered | null)[];
  }[];
}

/** Seconds from which a cell counts as covered: the API's. */
const ENOUGH = 1;

/** "0.5 – 1", "over 2", "under -90" */
export function rangeOf(least: number | null, most: number | null): string {
  if (least === null) return `under ${most ?? ""}`;
  return most === null ? `over ${least}` : `${least} – ${most}`;
}

export function gridOf(cells: readonly Cell[]): Grid {
  const turns = ordered(cells, ({ min_turn, max_turn }) => [
    min_turn ?? -Infinity,
    rangeOf(min_turn, max_turn),
  ]);
  const speeds = ordered(cells, ({ min_speed, max_speed }) => [
    min_speed,
    rangeOf(min_speed, max_speed),
  ]);
  const rows = speeds.map((speed) => ({
    speed,
    cells: turns.map((turn) => {
      const cell = cells.find(
        (one) =>
          rangeOf(one.min_speed, one.max_speed) === speed &&
          rangeOf(one.min_turn, one.max_turn) === turn,
      );
      return cell ? covered(cell) : null;
    }),
  }));
  return { turns, rows };
}

function covered({ seconds, library_seconds: library }: Cell): Covered {
  const isMissing = library >= ENOUGH;
  const state = seconds >= ENOUGH ? "covered" : isMissing ? "missing" : "rare";
  return { state, seconds, library };
}

function ordered(
  cells: readonly Cell[],
  named: (cell: Cell) => readonly [number, string],
): readonly string[] {
  const found = new Map(cells.map(named).map(([least, name]) => [name, least]));
  return [...found].sort(([, one], [, other]) => one - other).map(([name]) => name);
}
