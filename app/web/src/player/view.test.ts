import { describe, expect, it } from "vitest";
import { HOME, readCamera, within, writeCamera, type Camera } from "./view";

describe("the camera in an address", () => {
  it("is read as it was written", () => {
    const camera: Camera = { azimuth: -120, polar: 60, distance: 3.25, shift: [0, 0, 0] };
    expect(writeCamera(camera)).toBe("-120,60,3.25");
    expect(readCamera(writeCamera(camera))).toEqual(camera);
    const shifted: Camera = { ...camera, shift: [0.25, -1, 0] };
    expect(readCamera(writeCamera(shifted))).toEqual(shifted);
  });

  it.each(["", "a,b,c", "10,20", "10,20,-1", "10,300,2", "1,2,3,x"])(
    "%o is the usual one",
    (text) => {
      expect(readCamera(text)).toEqual(HOME);
    },
  );
});

describe("the time that is played", () => {
  it("begins again at the end of a loop", () => {
    expect(within(2.25, [1, 2], true)).toEqual({ time: 1.25, isOver: false });
    expect(within(0.5, [1, 2], true)).toEqual({ time: 1, isOver: false });
  });

  it("stops at the end otherwise", () => {
    expect(within(2.25, [1, 2], false)).toEqual({ time: 2, isOver: true });
    expect(within(1, [1, 1], true)).toEqual({ time: 1, isOver: true });
  });
});
