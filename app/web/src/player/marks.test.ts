import { describe, expect, it } from "vitest";
import { curvePath, namesOf, posePath, retimed } from "./marks";

describe("pictures of the time line", () => {
  it("a curve fills its room", () => {
    expect(curvePath([0, 2, 1], 10, 4)).toBe("M0.0 4.0L5.0 0.0L10.0 2.0");
    expect(curvePath([1], 10, 4)).toBe("");
    expect(curvePath(Array<number>(1000).fill(1), 10, 4).split("L")).toHaveLength(10);
  });

  it("names of spans are written where they have room", () => {
    const span = (start: number, label: string) => ({ start, end: start + 1, label });
    const spans = [span(0, "gap"), span(0.1, "jump"), span(9.9, "frozen"), span(2, "x".repeat(99))];
    expect(namesOf(spans, (seconds) => seconds * 20, 200)).toEqual([
      { text: "gap", x: 0, anchor: "start" },
      { text: "frozen", x: 198, anchor: "end" },
    ]);
  });

  it("a pose stands on its place", () => {
    const pose = Array.from({ length: 13 }, (_, joint) => [
      joint === 10 ? 0.5 : 0,
      joint === 10 ? 2 : 0,
      0,
    ]);
    expect(posePath(pose, [[4, 10]], 20)).toBe("M0.0 0.0L5.0 -20.0");
  });
});

describe("marks on another clock", () => {
  it("are those of the part, where the player shows them", () => {
    const marks = {
      keyposes: [0, 1, 3].map((time) => ({ time, pose: [], isNamed: false })),
      beats: [0.5, 1.5],
      segments: [
        { start: 0, end: 0.9, label: "before" },
        { start: 0.5, end: 2, label: "within" },
      ],
      energy: Array.from({ length: 40 }, (_, frame) => frame),
      energyRate: 10,
    };
    // The player shows seconds 1 to 3 of the clip at half the speed.
    const found = retimed(marks, {
      seconds: 4,
      isShown: (own) => own >= 1 && own <= 3,
      timeOf: (own) => 2 * (own - 1),
      ownAt: (time) => 1 + time / 2,
    });
    expect(found.keyposes.map(({ time }) => time)).toEqual([0, 4]);
    expect(found.beats).toEqual([1]);
    expect(found.segments).toEqual([{ start: -1, end: 2, label: "within" }]);
    expect(found.energy).toHaveLength(4 * found.energyRate);
    expect([found.energy[0], found.energy[60]]).toEqual([10, 20]);
  });
});
