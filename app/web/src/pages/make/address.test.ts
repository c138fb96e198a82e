import { describe, expect, it } from "vitest";
import { clipIds, MAX_OWN_CLIPS } from "./address";

describe("the clips of one person", () => {
  it("are ids with commas between them, each once", () => {
    expect(clipIds("")).toEqual([]);
    expect(clipIds("a, b,,a")).toEqual(["a", "b"]);
  });

  it("are at most as many as the page takes", () => {
    const many = Array.from({ length: MAX_OWN_CLIPS + 1 }, (_, place) => `clip_${place}`);
    expect(clipIds(many.join(","))).toHaveLength(MAX_OWN_CLIPS);
  });
});
