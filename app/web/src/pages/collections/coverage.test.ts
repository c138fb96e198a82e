import { expect, it } from "vitest";
import { gridOf, rangeOf } from "./coverage";

const cell = (
  min_speed: number,
  max_speed: number | null,
  min_turn: number | null,
  seconds: number,
) => ({
  min_speed,
  max_speed,
  min_turn,
  max_turn: min_turn === null ? -30 : null,
  seconds,
  library_seconds: 4,
});

it("speeds by turns, each covered or missing", () => {
  const grid = gridOf([cell(1, null, 30, 0.2), cell(0, 1, null, 2), cell(0, 1, 30, 0)]);
  expect(grid.turns).toEqual(["under -30", "over 30"]);
  expect(grid.rows.map(({ speed }) => speed)).toEqual(["0 – 1", "over 1"]);
  expect(grid.rows[0]?.cells.map((one) => one?.state)).toEqual(["covered", "missing"]);
  expect(grid.rows[1]?.cells).toEqual([null, { state: "missing", seconds: 0.2, library: 4 }]);
  expect(rangeOf(0.5, 1)).toBe("0.5 – 1");
});
