/**
 * The surface of solids that run into each other, as triangles: naive surface nets (Gibson 1998,
 * "Constrained elastic surface nets") on a grid of their smooth union, moved onto the surface.
 */
import { Vector3 } from "three";
import type { Solid } from "./solids";

export interface Surface {
  /** (vertices, 3) meters, and unit vectors that point outward. */
  readonly points: Float32Array;
  readonly normals: Float32Array;
  /** (triangles, 3) vertices, seen from outside against the clock. */
  readonly triangles: Uint32Array;
}

/** Where no solid is near. */
const FAR = 1;
/** Cells: so far from the surface, no cell is cut by it; distances are right within a factor of 2. */
const CLEAR = 4;
/** Newton's steps, and the cells of the differences that give the slope. */
const STEPS = 2;
const DIFFERENCE = 0.1;

/** The surface at 0 of the union of `solids`, whose seams are `round` meters wide. */
export function surfaceOf(solids: readonly Solid[], cell: number, round: number): Surface {
  const grid = gridOf(solids, cell, round);
  const found = vertices(grid);
  const points = new Float32Array(found.points);
  const normals = settled(points, solids, cell, round);
  return { points, normals, triangles: faces(grid, found.numbers) };
}

/** Moves points onto the surface (Newton's method); gives the normals there. */
function settled(
  points: Float32Array,
  solids: readonly Solid[],
  cell: number,
  round: number,
): Float32Array {
  const normals = new Float32Array(points.length);
  const point = new Vector3();
  const normal = new Vector3();
  for (let at = 0; at < points.length; at += 3) {
    point.fromArray(points, at);
    const near = solids.filter(({ low, high }) => isNear(point, low, high, round + cell));
    for (let step = 0; step < STEPS; step += 1) {
      const distance = distanceAt(near, point.x, point.y, point.z, round);
      const small = cell * DIFFERENCE;
      normal.set(
        distanceAt(near, point.x + small, point.y, point.z, round) - distance,
        distanceAt(near, point.x, point.y + small, point.z, round) - distance,
        distanceAt(near, point.x, point.y, point.z + small, round) - distance,
      );
      const steep = normal.length() / small;
      normal.normalize();
      const move = steep > 0 ? distance / steep : 0;
      point.addScaledVector(normal, -Math.min(Math.max(move, -cell / 2), cell / 2));
    }
    point.toArray(points, at);
    normal.toArray(normals, at);
  }
  return normals;
}

function isNear({ x, y, z }: Vector3, low: Vector3, high: Vector3, margin: number): boolean {
  const beyond = Math.max(low.x - x, low.y - y, low.z - z, x - high.x, y - high.y, z - high.z);
  return beyond < margin;
}

function distanceAt(
  solids: readonly Solid[],
  x: number,
  y: number,
  z: number,
  round: number,
): number {
  let found = FAR;
  for (const solid of solids) found = united(found, solid.distance(x, y, z), round);
  return found;
}

interface Grid {
  readonly values: Float32Array;
  /** Points along each axis. */
  readonly size: readonly [number, number, number];
  /** Steps in `values` along each axis. */
  readonly steps: readonly [number, number, number];
  readonly low: readonly [number, number, number];
  readonly cell: number;
}

function gridOf(solids: readonly Solid[], cell: number, round: number): Grid {
  const margin = round + 2 * cell;
  const axes = ["x", "y", "z"] as const;
  const low = axes.map((axis) => Math.min(...solids.map((solid) => solid.low[axis])) - margin);
  const high = axes.map((axis) => Math.max(...solids.map((solid) => solid.high[axis])) + margin);
  const [x0 = 0, y0 = 0, z0 = 0] = low;
  const [nx = 0, ny = 0, nz = 0] = high.map(
    (most, axis) => Math.ceil((most - (low[axis] ?? 0)) / cell) + 1,
  );
  const values = new Float32Array(nx * ny * nz).fill(FAR);
  for (const solid of solids) {
    const first = (value: number, start: number): number =>
      Math.max(0, Math.floor((value - margin - start) / cell));
    const last = (value: number, start: number, count: number): number =>
      Math.min(count - 1, Math.ceil((value + margin - start) / cell));
    for (let k = first(solid.low.z, z0); k <= last(solid.high.z, z0, nz); k += 1) {
      for (let j = first(solid.low.y, y0); j <= last(solid.high.y, y0, ny); j += 1) {
        for (let i = first(solid.low.x, x0); i <= last(solid.high.x, x0, nx); i += 1) {
          const at = i + nx * (j + ny * k);
          const distance = solid.distance(x0 + i * cell, y0 + j * cell, z0 + k * cell);
          values[at] = united(values[at] ?? FAR, distance, round);
        }
      }
    }
  }
  return { values, size: [nx, ny, nz], steps: [1, nx, nx * ny], low: [x0, y0, z0], cell };
}

/** The smaller of two distances, rounded where they are nearly the same (Quilez, "smooth min"). */
function united(some: number, other: number, round: number): number {
  const share = Math.max(0, round - Math.abs(some - other)) / round;
  return Math.min(some, other) - (share * share * round) / 4;
}

const CORNERS = [0, 1, 2, 3, 4, 5, 6, 7];
/** The edges of a cell: pairs of corners that differ in one bit. */
const EDGES = CORNERS.flatMap((corner) =>
  [1, 2, 4].filter((bit) => !(corner & bit)).map((bit) => [corner, corner | bit] as const),
);

/** A vertex in each cell that the surface cuts: the middle of the cuts of its edges. */
function vertices({ values, size, steps, low, cell }: Grid): {
  points: number[];
  numbers: Map<number, number>;
} {
  const points: number[] = [];
  const numbers = new Map<number, number>();
  const offsets = CORNERS.map(
    (corner) => (corner & 1) * steps[0] + ((corner >> 1) & 1) * steps[1] + (corner >> 2) * steps[2],
  );
  for (let k = 0; k + 1 < size[2]; k += 1) {
    for (let j = 0; j + 1 < size[1]; j += 1) {
      for (let i = 0; i + 1 < size[0]; i += 1) {
        const at = i + steps[1] * j + steps[2] * k;
        if (Math.abs(values[at] ?? FAR) > CLEAR * cell) continue;
        const middle = cutOf(offsets.map((offset) => values[at + offset] ?? FAR));
        if (!middle) continue;
        numbers.set(at, points.length / 3);
        const [x, y, z] = middle;
        points.push(low[0] + (i + x) * cell, low[1] + (j + y) * cell, low[2] + (k + z) * cell);
      }
    }
  }
  return { points, numbers };
}

/** The middle of the cuts of a cell's edges, in cells; null where the surface is elsewhere. */
function cutOf(corners: readonly number[]): [number, number, number] | null {
  const inside = corners.filter((value) => value < 0).length;
  if (inside === 0 || inside === corners.length) return null;
  const [sum, cuts] = [[0, 0, 0] as [number, number, number], { count: 0 }];
  for (const [from, to] of EDGES) {
    const [start = 0, end = 0] = [corners[from], corners[to]];
    if (start < 0 === end < 0) continue;
    const share = start / (start - end);
    cuts.count += 1;
    for (const axis of [0, 1, 2] as const) {
      const [a, b] = [(from >> axis) & 1, (to >> axis) & 1];
      sum[axis] += a + share * (b - a);
    }
  }
  return [sum[0] / cuts.count, sum[1] / cuts.count, sum[2] / cuts.count];
}

/** Two triangles for each edge of the grid that the surface cuts: of the four cells around it. */
function faces({ values, size, steps }: Grid, numbers: ReadonlyMap<number, number>): Uint32Array {
  const found: number[] = [];
  for (const at of numbers.keys()) {
    const place = [at % size[0], Math.floor(at / steps[1]) % size[1], Math.floor(at / steps[2])];
    for (const axis of [0, 1, 2] as const) {
      const [b, c] = [(axis + 1) % 3, (axis + 2) % 3] as [0 | 1 | 2, 0 | 1 | 2];
      if (place[b] === 0 || place[c] === 0) continue;
      const isInside = (values[at] ?? FAR) < 0;
      if (isInside === (values[at + steps[axis]] ?? FAR) < 0) continue;
      const around = [at, at - steps[b], at - steps[b] - steps[c], at - steps[c]];
      const [p = 0, q = 0, r = 0, s = 0] = around.map((cell) => numbers.get(cell) ?? 0);
      found.push(...(isInside ? [p, q, r, p, r, s] : [p, r, q, p, s, r]));
    }
  }
  return new Uint32Array(found);
}
