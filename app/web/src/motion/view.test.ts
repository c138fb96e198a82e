import { describe, expect, it } from "vitest";
import type { Motion } from "./motion";
import { HEAD, HIPS, ROLES } from "./roles";
import { viewOf } from "./view";

/** A body of which only the head stands 1.7 m over the floor, hips as told, one hand as told. */
function body(frames: { hips: [number, number]; hand: [number, number] }[]): Motion {
  const positions = new Float32Array(frames.length * ROLES.length * 3);
  frames.forEach(({ hips, hand }, frame) => {
    ROLES.forEach((name, joint) => {
      const at = (frame * ROLES.length + joint) * 3;
      const [x, z] = name === "left_hand" ? [hips[0] + hand[0], hips[1] + hand[1]] : hips;
      positions.set([x, joint === HEAD ? 1.7 : joint === HIPS ? 1 : 0, z], at);
    });
  });
  return { frameRate: 30, frames: frames.length, joints: ROLES.length, positions };
}

describe("the flat view of a body", () => {
  it("shows the direction of most movement", () => {
    const view = viewOf(
      body([-0.5, 0, 0.5].map((swing) => ({ hips: [0, 0], hand: [0.02 * swing, swing] }))),
    );
    expect(Math.abs(view.z)).toBeGreaterThan(0.99);
    expect([view.floor, view.top]).toEqual([0, expect.closeTo(1.7)]);
    expect(view.follows).toBe(false);
  });

  it("goes with who travels, to the right", () => {
    const view = viewOf(
      body([0, 1, 2, 3, 4].map((far) => ({ hips: [-far, 0], hand: [(far % 2) - 0.5, 0] }))),
    );
    expect(view.x).toBeCloseTo(-1);
    expect(view.follows).toBe(true);
    expect(view.right - view.left).toBeLessThan(1.1);
  });
});
