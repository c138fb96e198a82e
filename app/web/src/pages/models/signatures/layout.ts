/** Signatures as numbers to show: places in a picture, and weights that can be compared. */
import type { Schemas } from "$/api/client";

export const WIDTH = 480;
export const HEIGHT = 300;
const ROOM = 44;

export interface Spot {
  readonly key: string;
  readonly name: string;
  readonly x: number;
  readonly y: number;
}
export interface Given {
  readonly key: string;
  readonly name: string;
  readonly point: readonly number[];
}

/** Points at the same scale in both directions, in the middle of the picture; y goes up. */
export function placed(given: readonly Given[]): readonly Spot[] {
  const xs = given.map(({ point }) => point[0] ?? 0);
  const ys = given.map(({ point }) => point[1] ?? 0);
  const [left, top] = [Math.min(...xs), Math.max(...ys)];
  const wide = Math.max(...xs) - left || 1;
  const tall = top - Math.min(...ys) || 1;
  const scale = Math.min((WIDTH - 2 * ROOM) / wide, (HEIGHT - 2 * ROOM) / tall);
  return given.map(({ key, name }, place) => ({
    key,
    name,
    x: WIDTH / 2 + ((xs[place] ?? 0) - left - wide / 2) * scale,
    y: HEIGHT / 2 + (top - (ys[place] ?? 0) - tall / 2) * scale,
  }));
}

/** Weights in standard deviations from their means: all of them have the same scale then. */
export function standardized(
  weights: readonly number[],
  motions: readonly Pick<Schemas["Eigenmotion"], "mean" | "deviation">[],
): readonly number[] {
  return motions.map(({ mean, deviation }, place) =>
    deviation > 0 ? ((weights[place] ?? mean) - mean) / deviation : 0,
  );
}
