import { expect, it } from "vitest";
import { frameRateFor } from "./clips";

it("a clip is loaded at its own rate, unless that is more than is seen or fits", () => {
  expect(frameRateFor({ frame_rate: 30, duration: 5, joints: 22 })).toBe(30);
  expect(frameRateFor({ frame_rate: 120, duration: 5, joints: 22 })).toBe(60);
  expect(frameRateFor({ frame_rate: 120, duration: 1800, joints: 60 })).toBe(24);
  expect(frameRateFor({ frame_rate: null, duration: null, joints: null })).toBe(60);
});
