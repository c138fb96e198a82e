import { describe, expect, it } from "vitest";
import { placeOf, spansOf, type Warning } from "./warnings";

const WHOLE: Warning = {
  code: "unit_guessed",
  detail: "It looks like centimeters.",
  likely: 0.01,
  start: null,
  end: null,
  joint: null,
};
const JUMP: Warning = { ...WHOLE, code: "bone_length_jumps", start: 0.4, end: 0.49, joint: "Knee" };

describe("the places of warnings", () => {
  it("are said as far as they are known", () => {
    expect(placeOf(JUMP)).toBe("0.40 – 0.49 s, Knee");
    expect(placeOf({ ...JUMP, end: 0.4, joint: null })).toBe("0.40 s");
    expect(placeOf({ ...WHOLE, joint: "Knee" })).toBe("Knee");
    expect(placeOf(WHOLE)).toBe("");
  });

  it("are marks of the time line where they have a time", () => {
    expect(spansOf([WHOLE, JUMP, { ...JUMP, end: null, joint: null }])).toEqual([
      { start: 0.4, end: 0.49, label: "bone length jumps: Knee" },
      { start: 0.4, end: 0.4, label: "bone length jumps" },
    ]);
  });
});
