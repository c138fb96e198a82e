import { describe, expect, it } from "vitest";
import { aligned } from "./lines";

const LINES = [
  {
    name: "a",
    points: [
      [2, 5],
      [1, 0],
    ],
  },
  {
    name: "b",
    points: [
      [3, 1],
      [4, 1e-20],
    ],
  },
] as const;

describe("lines of a plot", () => {
  it("share their x, and have a gap where a line has no point", () => {
    expect(aligned(LINES)).toEqual([
      [1, 2, 3, 4],
      [0, 5, null, null],
      [null, null, 1, 1e-20],
    ]);
  });

  it("have no rounding errors on a logarithmic axis", () => {
    expect(aligned(LINES, true)).toEqual([
      [2, 3],
      [5, null],
      [null, 1],
    ]);
  });
});
