/** The map's state in its address: what it shows, and the query whose hits are lit. */
import { choice, text, type Values } from "$/core/query";
import { SEARCH } from "$/pages/search/address";

export const SPACES = { symbols: "Motion symbols", vectors: "Motion vectors" } as const;
export type Space = keyof typeof SPACES;

export const MAP = {
  ...SEARCH,
  space: choice(Object.keys(SPACES) as Space[], "symbols"),
  /** What colors the points: a label, a measure, or a key of the metadata as meta.KEY. */
  color: text("task"),
  /** What is seen: the middle and the zoom. */
  view: text(),
  /** Corners of the outline whose clips are chosen. */
  lasso: text(),
  /** The value of the color whose clips are chosen. */
  pick: text(),
  /** Id of the clip whose card stays open. */
  at: text(),
};
export type MapValues = Values<typeof MAP>;

/** A place of the map in the units of its points. */
export type Spot = readonly [x: number, y: number];

/** Corners that an address holds. */
const MAX_CORNERS = 48;

export function writeLasso(corners: readonly Spot[]): string {
  const step = Math.max(1, Math.ceil(corners.length / MAX_CORNERS));
  return corners
    .filter((_, place) => place % step === 0)
    .map((corner) => corner.map((value) => Number(value.toPrecision(4))).join(","))
    .join(" ");
}

/** The corners in a text; none where it cannot be read. */
export function readLasso(written: string): readonly Spot[] {
  const corners = written.split(" ").map((corner) => corner.split(",").map(Number));
  const isWhole = corners.every((corner) => corner.length === 2 && corner.every(Number.isFinite));
  return isWhole ? corners.map(([x = 0, y = 0]) => [x, y] as const) : [];
}
