import { expect, it } from "vitest";
import { inOrder } from "./order";

const hit = (duration: number, tempo: number | null) => ({
  clip: { duration, tempo, speed: null, travel: null, energy: null },
});

it("hits stand in the order of a measure, those without it last", () => {
  const [a, b, c] = [hit(2, 90), hit(3, null), hit(1, 120)];
  expect(inOrder([a, b, c], "best")).toEqual([a, b, c]);
  expect(inOrder([a, b, c], "duration")).toEqual([c, a, b]);
  expect(inOrder([b, a, c], "-tempo")).toEqual([c, a, b]);
});
