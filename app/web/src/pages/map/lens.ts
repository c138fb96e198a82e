/** Between places of the map and pixels of its canvas. */
import type { Spot } from "./address";

/** The rectangle of all points. */
export interface Bounds {
  readonly middle: Spot;
  readonly width: number;
  readonly height: number;
}

/** What is seen: the place in the middle, and how much larger than the whole map. */
export interface View {
  readonly middle: Spot;
  readonly zoom: number;
}

export interface Size {
  readonly width: number;
  readonly height: number;
}

const MAX_ZOOM = 500;
const MIN_ZOOM = 0.5;
/** Room around the points. */
const MARGIN = 1.12;

export function boundsOf(points: Float32Array): Bounds {
  let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
  for (let at = 0; at < points.length; at += 2) {
    const [x, y] = [points[at] ?? 0, points[at + 1] ?? 0];
    left = Math.min(left, x);
    right = Math.max(right, x);
    low = Math.min(low, y);
    high = Math.max(high, y);
  }
  if (points.length === 0) return { middle: [0, 0], width: 1, height: 1 };
  const middle = [(left + right) / 2, (low + high) / 2] as const;
  return { middle, width: right - left || 1, height: high - low || 1 };
}

/** Units of the map that a pixel covers. */
export function unitsOf({ zoom }: View, bounds: Bounds, size: Size): number {
  const whole = Math.max(bounds.width / size.width, bounds.height / size.height);
  return (whole * MARGIN) / zoom;
}

export function toPixel([x, y]: Spot, view: View, units: number, size: Size): Spot {
  return [
    size.width / 2 + (x - view.middle[0]) / units,
    size.height / 2 - (y - view.middle[1]) / units,
  ];
}

export function fromPixel([x, y]: Spot, view: View, units: number, size: Size): Spot {
  return [
    view.middle[0] + (x - size.width / 2) * units,
    view.middle[1] - (y - size.height / 2) * units,
  ];
}

/** The view after a zoom that leaves the place under a pixel where it is. */
export function zoomed(view: View, by: number, pixel: Spot, bounds: Bounds, size: Size): View {
  const zoom = Math.min(Math.max(MIN_ZOOM, view.zoom * by), MAX_ZOOM);
  const before = fromPixel(pixel, view, unitsOf(view, bounds, size), size);
  const next = { ...view, zoom };
  const after = fromPixel(pixel, next, unitsOf(next, bounds, size), size);
  const middle = [
    view.middle[0] + before[0] - after[0],
    view.middle[1] + before[1] - after[1],
  ] as const;
  return { middle, zoom };
}

/** `x,y,zoom` as a view; the whole map where it cannot be read. */
export function readView(text: string, bounds: Bounds): View {
  const [x = NaN, y = NaN, zoom = NaN] = text.split(",").map(Number);
  const isView = Number.isFinite(x) && Number.isFinite(y) && zoom >= MIN_ZOOM && zoom <= MAX_ZOOM;
  return text !== "" && isView ? { middle: [x, y], zoom } : { middle: bounds.middle, zoom: 1 };
}

export function writeView({ middle, zoom }: View): string {
  return [...middle, zoom].map((value) => Number(value.toPrecision(5))).join(",");
}

/** Index of the point nearest to a place, within `reach` units; -1 where there is none. */
export function nearest([x, y]: Spot, points: Float32Array, reach: number): number {
  let [best, least] = [-1, reach * reach];
  for (let at = 0; at < points.length; at += 2) {
    const [aside, above] = [(points[at] ?? 0) - x, (points[at + 1] ?? 0) - y];
    const distance = aside * aside + above * above;
    if (distance <= least) [best, least] = [at / 2, distance];
  }
  return best;
}
