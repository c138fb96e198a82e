import { describe, expect, it } from "vitest";
import { readLasso, writeLasso } from "./address";
import { choices, coloring, NONE, ofClass, OTHER, type MapClip } from "./colors";
import { inside } from "./lasso";
import {
  boundsOf,
  fromPixel,
  nearest,
  readView,
  toPixel,
  unitsOf,
  writeView,
  zoomed,
} from "./lens";

const clip = (some: Partial<MapClip>): MapClip =>
  ({ words: [], metadata: {}, person: null, task: null, duration: null, ...some }) as MapClip;
const POINTS = Float32Array.from([0, 0, 4, 0, 4, 2, 1, 1]);
const SIZE = { width: 200, height: 100 };

describe("the lasso", () => {
  it("encloses what is inside, also of an outline with a bay", () => {
    expect(
      inside(
        [
          [-1, -1],
          [2, -1],
          [2, 2],
          [-1, 2],
        ],
        POINTS,
      ),
    ).toEqual([0, 3]);
    expect(
      inside(
        [
          [-1, -1],
          [5, -1],
          [5, 3],
          [3, 0.5],
          [-1, 3],
        ],
        POINTS,
      ),
    ).toEqual([0, 1, 3]);
    expect(
      inside(
        [
          [0, 0],
          [1, 1],
        ],
        POINTS,
      ),
    ).toEqual([]);
  });

  it("is an address of few corners", () => {
    const many = Array.from({ length: 500 }, (_, place) => [place / 3, 1.23456] as const);
    const read = readLasso(writeLasso(many));
    expect(read.length).toBeLessThanOrEqual(48);
    expect(read[1]?.[1]).toBe(1.235);
    expect(readLasso("nonsense")).toEqual([]);
  });
});

describe("the lens", () => {
  const bounds = boundsOf(POINTS);
  const whole = readView("", bounds);

  it("sees the whole map at first", () => {
    expect(whole).toEqual({ middle: [2, 1], zoom: 1 });
    const units = unitsOf(whole, bounds, SIZE);
    expect(toPixel([2, 1], whole, units, SIZE)).toEqual([100, 50]);
    expect(fromPixel(toPixel([3, 2], whole, units, SIZE), whole, units, SIZE)[0]).toBeCloseTo(3);
  });

  it("zooms at the pixel under the pointer, and is an address", () => {
    const near = zoomed(whole, 2, [200, 50], bounds, SIZE);
    const before = fromPixel([200, 50], whole, unitsOf(whole, bounds, SIZE), SIZE);
    const after = fromPixel([200, 50], near, unitsOf(near, bounds, SIZE), SIZE);
    expect(after[0]).toBeCloseTo(before[0]);
    expect(readView(writeView(near), bounds).zoom).toBe(2);
    expect(readView("1,2,x", bounds)).toEqual(whole);
  });

  it("finds the nearest point within reach", () => {
    expect(nearest([3.9, 1.8], POINTS, 0.5)).toBe(2);
    expect(nearest([2.5, 1], POINTS, 0.5)).toBe(-1);
  });
});

describe("the colors", () => {
  it("are classes by how many clips have a value; the rarer share one", () => {
    const clips = Array.from({ length: 24 }, (_, place) =>
      clip({ task: place < 3 ? "walk" : place < 23 ? `task ${place % 11}` : null }),
    );
    const found = coloring(clips, "task");
    if (found.kind !== "classes") throw new Error("expected classes");
    expect(found.classes[0]).toEqual({ value: "walk", count: 3 });
    expect([found.others, found.none]).toEqual([2, 1]);
    expect(found.of[23]).toBe(NONE);
    expect([...found.of].filter((one) => one === OTHER)).toHaveLength(2);
    expect(ofClass(found, "walk")).toEqual([0, 1, 2]);
  });

  it("are a range of numbers, also of metadata", () => {
    const clips = [clip({ metadata: { age: 20 } }), clip({ metadata: { age: 40 } }), clip({})];
    expect(choices(clips).map(([name]) => name)).toContain("meta.age");
    const found = coloring(clips, "meta.age");
    expect(found).toMatchObject({ kind: "range", least: 20, most: 40 });
    expect([...found.of]).toEqual([0, 1, NaN]);
  });

  it("take of several words the one that most clips carry", () => {
    const found = coloring([clip({ words: ["slow", "kick"] }), clip({ words: ["kick"] })], "word");
    expect(found).toMatchObject({ classes: [{ value: "kick", count: 2 }] });
  });
});
