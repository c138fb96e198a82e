import { describe, expect, it } from "vitest";
import { between, lanesOf, moved, nextPart, textOf } from "./lanes";

describe("lanes", () => {
  it("hold parts that do not cover each other", () => {
    const parts = [
      { start: 0, end: 2 },
      { start: 1, end: 3 },
      { start: 2, end: 4 },
      { start: 2.5, end: 5 },
    ];
    expect(lanesOf(parts)).toEqual([0, 1, 0, 2]);
    expect(lanesOf([])).toEqual([]);
  });
});

describe("a part", () => {
  it("lies between two times, within the clip, and has a length", () => {
    expect(between(2, 1, 5)).toEqual({ start: 1, end: 2 });
    expect(between(-1, 0.5, 5)).toEqual({ start: 0, end: 0.5 });
    expect(between(4.98, 9, 5)).toEqual({ start: 4.9, end: 5 });
    expect(between(1, 1, 5)).toEqual({ start: 1, end: 1.1 });
    expect(between(0, 9, 4.98333).end).toBeLessThanOrEqual(4.98333);
  });

  it("keeps one end while the other is moved", () => {
    expect(moved({ start: 1, end: 2 }, "start", 1.5)).toEqual({ start: 1.5, end: 2 });
    expect(moved({ start: 1, end: 2 }, "start", 3)).toEqual({ start: 1.9, end: 2 });
    expect(moved({ start: 1, end: 2 }, "end", 0)).toEqual({ start: 1, end: 1.1 });
  });

  it("that comes next is the range that is played, or a second from now on", () => {
    expect(nextPart(1, null, null, 5)).toEqual({ start: 1, end: 2 });
    expect(nextPart(1, 2, null, 5)).toEqual({ start: 2, end: 5 });
    expect(nextPart(1, 2, 3, 5)).toEqual({ start: 2, end: 3 });
  });

  it("says its words, or else its sentence or its person", () => {
    expect(textOf({ words: ["left_leg", "kick"], text: "A kick." })).toBe("left leg, kick");
    expect(textOf({ words: [], person: "ada", text: null })).toBe("ada");
  });
});
