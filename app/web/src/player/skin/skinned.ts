/** Moves the points of a skin with the parts of the body (linear blend skinning). */
import type { Matrix4 } from "three";
import { MAX_PARTS, type BodyMesh } from "./mesh";

/** Numbers of a matrix that move a point: its first three rows. */
const NUMBERS = 12;

/** Writes the points and the normals (vertices, 3) of a mesh whose parts are moved by `matrices`. */
export function skinned(
  { points, normals, indices, weights }: BodyMesh,
  matrices: readonly Matrix4[],
  outPoints: Float32Array,
  outNormals: Float32Array,
): void {
  const rows = rowsOf(matrices);
  const blend = new Float32Array(NUMBERS);
  for (let at = 0, first = 0; at < points.length; at += 3, first += MAX_PARTS) {
    blend.fill(0);
    // The parts of a point come with falling weights.
    for (let place = first; place < first + MAX_PARTS; place += 1) {
      const weight = weights[place] ?? 0;
      if (weight === 0) break;
      const row = (indices[place] ?? 0) * NUMBERS;
      for (let each = 0; each < NUMBERS; each += 1) blend[each]! += weight * rows[row + each]!;
    }
    turned(blend, points, at, 1, outPoints);
    turned(blend, normals, at, 0, outNormals);
  }
}

/** The first three rows of each matrix, one after the other. */
function rowsOf(matrices: readonly Matrix4[]): Float32Array {
  const rows = new Float32Array(matrices.length * NUMBERS);
  matrices.forEach(({ elements }, part) => {
    for (let each = 0; each < NUMBERS; each += 1) {
      rows[part * NUMBERS + each] = elements[(each % 4) * 4 + Math.floor(each / 4)] ?? 0;
    }
  });
  return rows;
}

/** One vector of `from` through the three rows of a matrix; `shift`: 1 for a point, 0 else. */
function turned(
  matrix: Float32Array,
  from: Float32Array,
  at: number,
  shift: number,
  out: Float32Array,
): void {
  const [x, y, z] = [from[at]!, from[at + 1]!, from[at + 2]!];
  for (let axis = 0; axis < 3; axis += 1) {
    const row = axis * 4;
    out[at + axis] =
      matrix[row]! * x + matrix[row + 1]! * y + matrix[row + 2]! * z + matrix[row + 3]! * shift;
  }
}
