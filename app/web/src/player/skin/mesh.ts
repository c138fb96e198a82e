/** The skin of a body as a mesh: its surface at rest, and the parts that move each of its points. */
import {
  BufferGeometry,
  Float32BufferAttribute,
  Uint16BufferAttribute,
  BufferAttribute,
} from "three";
import type { SkeletonMotion } from "$/motion/motion";
import type { Side } from "$/motion/skeleton";
import { PARTS, type Part } from "./frames";
import type { Anatomy } from "./anatomy";
import { restOf, type Rest } from "./rest";
import { solidsOf, type Solid } from "./solids";
import { surfaceOf } from "./surface";

/** Shares of the stature: the size of a cell of the surface, and the width of a seam. */
const CELL = 1 / 100;
const ROUND = 0.018;
/** Meters for a person of 1 m: a solid so much farther than the nearest moves a point e times less. */
const REACH = 0.006;
/** Beyond this many of them it moves nothing. */
const FAR = 12;
/** Parts that move one point: what a GPU takes. */
const MAX_PARTS = 4;
const NONE = Array.from({ length: MAX_PARTS }, () => [0, 0] as const);
const NUMBERS = Object.fromEntries(PARTS.map((part, at) => [part, at])) as Record<Part, number>;

export interface BodyMesh {
  readonly rest: Rest;
  readonly geometry: BufferGeometry;
}

/** The mesh of the body in a motion: at rest, with its weights as three.js's SkinnedMesh has them. */
export function meshOf(motion: SkeletonMotion, anatomy: Anatomy): BodyMesh {
  const rest = restOf(motion, anatomy);
  const solids = solidsOf(rest);
  const { points, triangles } = surfaceOf(solids, CELL * rest.stature, ROUND * rest.stature);
  const indices: number[] = [];
  const weights: number[] = [];
  for (let at = 0; at < points.length; at += 3) {
    const [x = 0, y = 0, z = 0] = points.subarray(at, at + 3);
    for (const [part, weight] of weightsAt(solids, x, y, z, REACH * rest.stature)) {
      indices.push(part);
      weights.push(weight);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  geometry.setAttribute("skinIndex", new Uint16BufferAttribute(indices, MAX_PARTS));
  geometry.setAttribute("skinWeight", new Float32BufferAttribute(weights, MAX_PARTS));
  geometry.setIndex(new BufferAttribute(triangles, 1));
  geometry.computeVertexNormals();
  return { rest, geometry };
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
export function sharesOf({ geometry }: BodyMesh, side: Side): Float32Array {
  const indices = geometry.getAttribute("skinIndex");
  const weights = geometry.getAttribute("skinWeight");
  const sides = PARTS.map((part) => (/^(left|right)_/.exec(part)?.[1] ?? "trunk") === side);
  return Float32Array.from({ length: indices.count }, (_, vertex) => {
    let sum = 0;
    for (let place = 0; place < MAX_PARTS; place += 1) {
      if (sides[indices.getComponent(vertex, place)]) sum += weights.getComponent(vertex, place);
    }
    return sum;
  });
}
