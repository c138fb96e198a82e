import { describe, expect, it } from "vitest";
import { agreements, Path, ranked, type Alignment } from "./path";

/** The second clip does the same at half the speed; both begin late in their clips. */
const COUNT = 41;
const path = Array.from({ length: COUNT }, (_, step) => [1 + step / 20, 5 + step / 10]);
const halfSpeed: Alignment = {
  distance: 0,
  body_lengths: [1, 1],
  path,
  joints: ["hips", "left_hand", "right_hand"],
  differences: path.map((_, step) => [0, 0.1, step / 100]),
  mean_differences: [0, 0.1, 0.2],
  peaks: [],
};

describe("a path as a clock", () => {
  const found = new Path(halfSpeed);

  it("takes the mean time of both, from zero", () => {
    expect(found.seconds).toBeCloseTo(3);
    expect(found.clock[0]).toBe(0);
    expect(found.clock[10]).toBeCloseTo(0.75);
  });

  it("gives the times of both clips", () => {
    for (const seconds of [0, 0.6, 1.5, 2.97, 3]) {
      const [first, second] = found.timesAt(seconds);
      expect(first).toBeCloseTo(1 + (seconds / 3) * 2, 3);
      expect(second).toBeCloseTo(5 + (seconds / 3) * 4, 3);
    }
    expect(found.timesAt(-1)).toEqual(found.timesAt(0));
    expect(found.timesAt(99)).toEqual(found.timesAt(3));
  });

  it("tells how much later the second clip is", () => {
    expect(found.laterAt(0)).toBeCloseTo(0);
    expect(found.laterAt(3)).toBeCloseTo(2);
  });

  it("finds the common time of a time of the first clip, and of both times", () => {
    expect(found.secondsAt(2)).toBeCloseTo(1.5);
    expect(found.secondsAt(99)).toBeCloseTo(3);
    expect(found.secondsOf([2, 7])).toBeCloseTo(1.5);
  });

  it("gives differences between two steps, and their means without the hips", () => {
    expect(found.differencesAt(0.75 + 0.0375)[2]).toBeCloseTo(0.105);
    expect(found.means[10]).toBeCloseTo(0.1);
    expect(found.differencesOf("right_hand")[7]).toBeCloseTo(0.07);
  });
});

it("the moments of agreement are the closest ones that are apart from each other", () => {
  const found = agreements(new Path(halfSpeed));
  expect(found).toHaveLength(5);
  expect(found[0]).toEqual({ seconds: 0, meters: 0.05 });
  const times = found.map(({ seconds }) => seconds);
  times
    .slice(1)
    .forEach((time, before) => expect(time - (times[before] ?? 0)).toBeGreaterThan(0.49));
});

it("waits are spread, so that no body stands and then jumps", () => {
  const waiting = [0, 1, 2, 3, 4, 4, 4, 4, 5, 6, 7, 8].map((at) => at / 10);
  const other = [0, 1, 2, 3, 4, 5, 6, 7, 7, 7, 7, 8].map((at) => at / 10);
  const found = new Path({
    ...halfSpeed,
    path: waiting.map((at, step) => [at, other[step] ?? 0]),
    differences: waiting.map(() => [0, 0, 0]),
  });
  let before = found.timesAt(0);
  for (let seconds = 0.05; seconds <= found.seconds; seconds += 0.05) {
    const now = found.timesAt(seconds);
    expect(now[0]).toBeGreaterThan(before[0] - 1e-9);
    expect(now[1]).toBeGreaterThan(before[1] - 1e-9);
    expect(now[0] + now[1]).toBeCloseTo(2 * seconds);
    before = now;
  }
  expect(found.timesAt(found.seconds)).toEqual([0.8, 0.8]);
});

it("a path of one step stands still", () => {
  const found = new Path({ ...halfSpeed, path: [[2, 3]], differences: [[0, 0.1, 0.3]] });
  expect(found.seconds).toBe(0);
  expect(found.timesAt(0)).toEqual([2, 3]);
  expect(found.differencesAt(0)).toEqual([0, 0.1, 0.3]);
});

it("joints are ranked by their difference, without the hips", () => {
  expect(ranked(halfSpeed)).toEqual([
    ["right_hand", 0.2],
    ["left_hand", 0.1],
  ]);
});
