/** Lines of a plot. */
import type { AlignedData } from "uplot";

export interface Line {
  readonly name: string;
  readonly points: readonly (readonly [x: number, y: number])[];
}

/** Of the largest value on a logarithmic axis: what is smaller is 0 but for the rounding. */
const LEAST_SHARE = 1e-6;

/** All lines over the x of all of them, rising. isLog: what is 0 or nearly 0 is left out. */
export function aligned(lines: readonly Line[], isLog = false): AlignedData {
  const most = Math.max(...lines.flatMap(({ points }) => points.map(([, y]) => y)));
  const least = isLog ? most * LEAST_SHARE : -Infinity;
  const all = lines.map(({ points }) => points.filter(([, y]) => y > least));
  const xs = [...new Set(all.flat().map(([x]) => x))].sort((one, other) => one - other);
  const ys = all.map((points) => {
    const byX = new Map(points);
    return xs.map((x) => byX.get(x) ?? null);
  });
  return [xs, ...ys];
}
