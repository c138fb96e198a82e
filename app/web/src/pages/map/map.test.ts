import { describe, expect, it } from "vitest";
import { readLasso, writeLasso } from "./address";
import { choices, coloring, NONE, ofClass, OTHER } from "./colors";
import { labeled, pointsOf, without, type Columns } from "./columns";
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

const columns = (some: Partial<Columns>): Columns => ({
  space: "vectors",
  dimensions: 2,
  variance_kept: 1,
  total: 3,
  library_version: 1,
  model: null,
  clip_ids: ["a", "b", "c"],
  points: [
    [0, 1, 2],
    [3, 4, 5],
  ],
  labels: {},
  words: { values: [[]], codes: [0, 0, 0] },
  measures: {},
  metadata: {},
  ...some,
});
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
    const tasks = Array.from({ length: 24 }, (_, place) =>
      place < 3 ? "walk" : place < 23 ? `task ${place % 11}` : null,
    );
    const values = [...new Set(tasks.filter((task) => task !== null))].toReversed();
    const codes = tasks.map((task) => (task === null ? -1 : values.indexOf(task)));
    const clips = tasks.map(String);
    const found = coloring(
      columns({ clip_ids: clips, labels: { task: { values, codes } } }),
      "task",
    );
    if (found.kind !== "classes") throw new Error("expected classes");
    expect(found.classes[0]).toEqual({ value: "walk", count: 3 });
    expect([found.others, found.none]).toEqual([2, 1]);
    expect(found.of[23]).toBe(NONE);
    expect([...found.of].filter((one) => one === OTHER)).toHaveLength(2);
    expect(ofClass(found, "walk")).toEqual([0, 1, 2]);
  });

  it("are a range of numbers, of measures and of metadata", () => {
    const some = columns({
      measures: { speed: [1, null, 3] },
      metadata: { age: { values: [20, 40], clips: [0, 1], codes: [0, 1] } },
    });
    expect(choices(some).map(([name]) => name)).toContain("meta.age");
    const found = coloring(some, "meta.age");
    expect(found).toMatchObject({ kind: "range", least: 20, most: 40 });
    expect([...found.of]).toEqual([0, 1, NaN]);
    expect([...coloring(some, "speed").of]).toEqual([0, NaN, 1]);
  });

  it("take of several words the one that most clips carry", () => {
    const words = { values: [["kick", "slow"], ["kick"], []], codes: [0, 1, 2] };
    const found = coloring(columns({ words }), "word");
    expect(found).toMatchObject({ classes: [{ value: "kick", count: 2 }], none: 1 });
  });

  it("are none for what no clip has", () => {
    expect([...coloring(columns({}), "meta.nobody").of]).toEqual([NONE, NONE, NONE]);
  });
});

describe("the columns", () => {
  const some = columns({
    labels: { task: { values: ["walk"], codes: [-1, 0, 0] } },
    words: { values: [["slow"], []], codes: [1, 0, 1] },
    measures: { speed: [1, 2, null] },
    metadata: { age: { values: [20], clips: [2], codes: [0] } },
  });

  it("are points, and what is known of a clip", () => {
    expect([...pointsOf(some)]).toEqual([0, 3, 1, 4, 2, 5]);
    expect(labeled(some, [1])[0]).toEqual({
      id: "b",
      person: null,
      task: "walk",
      words: ["slow"],
    });
    expect(labeled(some, [2])[0]?.words).toEqual([]);
  });

  it("leave out clips that are hidden", () => {
    const left = without(some, new Set(["b"]));
    expect(left.clip_ids).toEqual(["a", "c"]);
    expect([...pointsOf(left)]).toEqual([0, 3, 2, 5]);
    expect(labeled(left, [1])).toEqual(labeled(some, [2]));
    expect(left.measures["speed"]).toEqual([1, null]);
  });
});
