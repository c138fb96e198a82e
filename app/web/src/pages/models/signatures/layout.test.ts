import { expect, test } from "vitest";
import { HEIGHT, placed, standardized, WIDTH } from "./layout";

const named = (name: string, ...point: number[]) => ({ key: name, name, point });

test("points keep their proportions and stand in the middle", () => {
  const [a, b, c] = placed([named("a", 0, 0), named("b", 2, 0), named("c", 2, 1)]);
  if (!a || !b || !c) throw new Error("three points are placed");
  expect(a.y).toBe(b.y);
  expect(b.x).toBe(c.x);
  expect(b.x - a.x).toBeCloseTo(2 * (b.y - c.y));
  expect((a.x + b.x) / 2).toBeCloseTo(WIDTH / 2);
  expect((b.y + c.y) / 2).toBeCloseTo(HEIGHT / 2);
});

test("a single point stands in the middle", () => {
  const [only] = placed([named("a", 7, -3)]);
  expect(only?.x).toBeGreaterThan(0);
  expect(only?.y).toBeGreaterThan(0);
});

test("weights are compared in standard deviations", () => {
  const motions = [
    { mean: 4, deviation: 2 },
    { mean: 1, deviation: 0 },
  ];
  expect(standardized([5, 9], motions)).toEqual([0.5, 0]);
});
