import { describe, expect, it } from "vitest";
import { between, rgb } from "./color";

describe("colors", () => {
  it("are read from what browsers compute", () => {
    expect(rgb("rgb(1, 20, 255)")).toEqual([1, 20, 255]);
  });

  it("are mixed along a row of others, and end with it", () => {
    const row = [
      [0, 0, 0],
      [100, 0, 0],
      [100, 200, 0],
    ] as const;
    expect(between(row, 0.25)).toEqual([50, 0, 0]);
    expect(between(row, 0.75)).toEqual([100, 100, 0]);
    expect(between(row, 1)).toEqual([100, 200, 0]);
    expect(between(row, 2)).toEqual([100, 200, 0]);
    expect(between(row, -1)).toEqual([0, 0, 0]);
  });
});
