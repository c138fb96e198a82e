/** The scale of colors for differences. */
import { between, type Rgb } from "$/core/color";
import type { Alignment } from "./path";

/** The end of the scale, which so many of all differences reach at most. */
const SHARE = 0.95;
const STEP_METERS = 0.05;
const LEAST_METERS = 0.1;

/** The difference that gets the last color, in meters: a round number. */
export function topOf({ differences }: Alignment): number {
  const all = Float32Array.from(differences.flat()).toSorted();
  const high = all[Math.floor(SHARE * (all.length - 1))] ?? 0;
  return Math.max(LEAST_METERS, Math.ceil(high / STEP_METERS) * STEP_METERS);
}

/** A color for three.js: 0xrrggbb. */
export function hex([red, green, blue]: Rgb): number {
  return (Math.round(red) << 16) | (Math.round(green) << 8) | Math.round(blue);
}

/** The color of a difference in meters. */
export function colorOf(meters: number, top: number, ramp: readonly Rgb[]): number {
  return hex(between(ramp, meters / top));
}

/** "31 cm" */
export function inCm(meters: number): string {
  return `${(meters * 100).toFixed(meters < 0.0995 ? 1 : 0)} cm`;
}
