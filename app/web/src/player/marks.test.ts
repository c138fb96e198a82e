import { describe, expect, it } from "vitest";
import { curvePath, namesOf, posePath } from "./marks";

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
