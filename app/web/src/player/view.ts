/**
 * How the player shows what it plays: fields for the address of any page that has a player.
 * `new Address({ ...PLAYER, other: text() })`
 */
import { choice, flag, number, text, type Values } from "$/core/query";

const MAX_SECONDS = 1e6;
export const SPEEDS = [0.1, 0.25, 0.5, 1, 2] as const;

export const PLAYER = {
  /** Seconds. */
  t: number(0, 0, MAX_SECONDS),
  speed: number(1, SPEEDS[0], SPEEDS[4]),
  loop: flag(true),
  /** The range that is played, seconds; null: the whole. */
  from: number(null, 0, MAX_SECONDS),
  to: number(null, 0, MAX_SECONDS),
  /** What is seen of a body: its skin, or its bones. */
  body: choice(["skin", "bones"], "skin"),
  /** The view of the first person. */
  eyes: flag(false),
  follow: flag(true),
  place: flag(false),
  mirror: flag(false),
  ghosts: flag(false),
  trails: flag(false),
  names: flag(false),
  /** The name of a joint that is marked. */
  joint: text(),
  /** The camera around its target: azimuth and polar angle in degrees, distance and shift in
      meters. */
  cam: text(),
};

export type PlayerValues = Values<typeof PLAYER>;

/** What is turned on and off by a button and a key. */
export const TOGGLES = [
  ["eyes", "First person", "e"],
  ["follow", "Follow", "f"],
  ["place", "In place", "p"],
  ["mirror", "Mirror", "m"],
  ["ghosts", "Ghosts", "g"],
  ["trails", "Trails", "t"],
  ["names", "Names", "n"],
] as const;

/** The camera as at first. */
export const RESET = { cam: "", eyes: false, follow: true } as const;

export interface Camera {
  readonly azimuth: number;
  readonly polar: number;
  readonly distance: number;
  /** Meters: how far its target was shifted from the bodies. */
  readonly shift: readonly [number, number, number];
}

export const HOME: Camera = { azimuth: 35, polar: 78, distance: 4, shift: [0, 0, 0] };

/** `35,78,4` or, shifted, `35,78,4,0.5,0,-0.2` as a camera; HOME where it cannot be read. */
export function readCamera(text: string): Camera {
  const [azimuth = NaN, polar = NaN, distance = NaN, ...rest] = text.split(",").map(Number);
  const [x = 0, y = 0, z = 0] = rest;
  const isCamera = Math.abs(azimuth) <= 180 && polar >= 0 && polar <= 180 && distance > 0;
  const isRead = text !== "" && isCamera && [x, y, z].every(Number.isFinite);
  return isRead ? { azimuth, polar, distance, shift: [x, y, z] } : HOME;
}

export function writeCamera({ azimuth, polar, distance, shift }: Camera): string {
  const shown = `${azimuth.toFixed(0)},${polar.toFixed(0)},${Number(distance.toPrecision(3))}`;
  const rounded = shift.map((meters) => Number(meters.toFixed(2)));
  return rounded.some((meters) => meters !== 0) ? `${shown},${rounded.join(",")}` : shown;
}

/** A time within the range that is played; beyond its end from its beginning on, if it loops. */
export function within(
  seconds: number,
  [from, to]: readonly [number, number],
  loops: boolean,
): { time: number; isOver: boolean } {
  if (seconds < to) return { time: Math.max(from, seconds), isOver: false };
  if (!loops || to <= from) return { time: to, isOver: true };
  return { time: from + ((seconds - from) % (to - from)), isOver: false };
}
