import { describe, expect, it } from "vitest";
import type { Schemas } from "$/api/client";
import { apartOf, reasonOf } from "./duplicates";

const pair = (clip_id: string, other_id: string, kind: "cut" | "mirror", shift = 0) =>
  ({ clip_id, other_id, kind, distance: 0.0123, shift }) as Schemas["DuplicatePair"];
const GROUP = {
  keeper: "a",
  clips: ["a", "b", "c"].map((id) => ({ id, name: id.toUpperCase() })) as Schemas["Clip"][],
  pairs: [pair("b", "a", "cut", -0.2), pair("b", "c", "mirror")],
};

describe("a group of duplicates", () => {
  it("says how each clip is the same", () => {
    expect(reasonOf(GROUP, "a")).toBe("proposed to be kept");
    expect(reasonOf(GROUP, "b")).toBe("a part, distance 0.012");
    expect(reasonOf(GROUP, "c")).toBe("mirrored, as B");
  });

  it("plays the same moment of the take in both clips", () => {
    // B begins where A is at 0.2 s.
    expect(apartOf(GROUP.pairs[0], "a")).toBe(-0.2);
    expect(apartOf(GROUP.pairs[0], "b")).toBe(0.2);
    expect(apartOf(undefined, "a")).toBe(0);
  });
});
