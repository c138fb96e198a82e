/** Which points an outline encloses. */
import type { Spot } from "./address";

/** Indices of the points (x, y, one after the other) inside; the outline closes by itself. */
export function inside(corners: readonly Spot[], points: Float32Array): number[] {
  if (corners.length < 3) return [];
  const [xs, ys] = [corners.map(([x]) => x), corners.map(([, y]) => y)];
  const [left, right] = [Math.min(...xs), Math.max(...xs)];
  const [low, high] = [Math.min(...ys), Math.max(...ys)];
  const found: number[] = [];
  for (let index = 0; index * 2 < points.length; index += 1) {
    const [x, y] = [points[index * 2] ?? 0, points[index * 2 + 1] ?? 0];
    const isNear = x >= left && x <= right && y >= low && y <= high;
    if (isNear && isInside(corners, x, y)) found.push(index);
  }
  return found;
}

/** Whether a ray to the right crosses the outline an odd number of times. */
function isInside(corners: readonly Spot[], x: number, y: number): boolean {
  let isIn = false;
  let [fromX, fromY] = corners.at(-1) ?? [0, 0];
  for (const [toX, toY] of corners) {
    const crosses = toY > y !== fromY > y;
    if (crosses && x < ((fromX - toX) * (y - toY)) / (fromY - toY) + toX) isIn = !isIn;
    [fromX, fromY] = [toX, toY];
  }
  return isIn;
}
