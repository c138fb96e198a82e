/** The skin of a body as a mesh: its surface at rest, and the parts that move each of its points. */
import type { SkeletonMotion } from "$/motion/motion";
import type { Side } from "$/motion/skeleton";
import { PARTS, type Part } from "./frames";
import type { Anatomy } from "./anatomy";
import { restOf, type Rest } from "./rest";
import { solidsOf, type Solid } from "./solids";
import { surfaceOf } from "./surface";

/** Cells of the surface in a person's height: of one who is seen large, and of one of many. */
export const FINE = 90;
export const COARSE = 52;
/** Shares of the stature: the width of a seam. */
const ROUND = 0.018;
/** Meters for a person of 1 m: a solid so much farther than the nearest moves a point e times less. */
const REACH = 0.006;
/** Beyond this many of them it moves nothing. */
const FAR = 12;
/** Parts that move one point: more would not be seen. */
export const MAX_PARTS = 4;
const NONE = Array.from({ length: MAX_PARTS }, () => [0, 0] as const);
const NUMBERS = Object.fromEntries(PARTS.map((part, at) => [part, at])) as Record<Part, number>;

export interface BodyMesh {
  readonly rest: Rest;
  /** (vertices, 3) meters, at rest, and unit vectors. */
  readonly points: Float32Array;
  readonly normals: Float32Array;
  /** (triangles, 3) vertices. */
  readonly triangles: Uint32Array;
  /** (vertices, MAX_PARTS) the parts that move each point, and their weights, which fall and sum
      to 1. */
  readonly indices: Uint8Array;
  readonly weights: Float32Array;
}

/** The mesh of the body in a motion, at rest; `cells`: of the surface in the person's height. */
export function meshOf(motion: SkeletonMotion, anatomy: Anatomy, cells = FINE): BodyMesh {
  const rest = restOf(motion, anatomy);
  const solids = solidsOf(rest);
  const { points, normals, triangles } = surfaceOf(
    solids,
    rest.stature / cells,
    ROUND * rest.stature,
  );
  const indices: number[] = [];
  const weights: number[] = [];
  for (let at = 0; at < points.length; at += 3) {
    const [x = 0, y = 0, z = 0] = points.subarray(at, at + 3);
    for (const [part, weight] of weightsAt(solids, x, y, z, REACH * rest.stature)) {
      indices.push(part);
      weights.push(weight);
    }
  }
  return {
    rest,
    points,
    normals,
    triangles,
    indices: new Uint8Array(indices),
    weights: new Float32Array(weights),
  };
}

/** The MAX_PARTS parts that move a point most, and their weights; the weights sum to 1. */
function weightsAt(
  solids: readonly Solid[],
  x: number,
  y: number,
  z: number,
  reach: number,
): readonly (readonly [number, number])[] {
  const near = solids.filter(({ low, high }) => {
    const [beforeX, beforeY, beforeZ] = [low.x - x, low.y - y, low.z - z];
    const beyond = Math.max(beforeX, beforeY, beforeZ, x - high.x, y - high.y, z - high.z);
    return beyond < FAR * reach;
  });
  const distances = near.map((solid) => solid.distance(x, y, z));
  const nearest = Math.min(...distances);
  const sums = new Map<number, number>();
  near.forEach((solid, place) => {
    const weight = Math.exp((nearest - (distances[place] ?? 0)) / reach);
    for (const [part, share] of solid.shares(y)) {
      const at = NUMBERS[part];
      sums.set(at, (sums.get(at) ?? 0) + weight * share);
    }
  });
  const most = [...sums].sort((a, b) => b[1] - a[1]).slice(0, MAX_PARTS);
  const total = most.reduce((sum, [, weight]) => sum + weight, 0);
  const found = most.map(([part, weight]) => [part, weight / total] as const);
  return [...found, ...NONE.slice(found.length)];
}

/** How much of each point belongs to a side: (vertices,), from 0 to 1. */
export function sharesOf({ indices, weights }: BodyMesh, side: Side): Float32Array {
  const sides = PARTS.map((part) => (/^(left|right)_/.exec(part)?.[1] ?? "trunk") === side);
  return Float32Array.from({ length: weights.length / MAX_PARTS }, (_, vertex) => {
    let sum = 0;
    for (let place = vertex * MAX_PARTS; place < (vertex + 1) * MAX_PARTS; place += 1) {
      if (sides[indices[place] ?? 0]) sum += weights[place] ?? 0;
    }
    return sum;
  });
}
