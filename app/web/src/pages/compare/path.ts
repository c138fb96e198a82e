/** The warping path of two clips as a clock that both follow. */
import type { Schemas } from "$/api/client";

export type Alignment = Schemas["Alignment"];
export type Times = readonly [number, number];

/** A step of the path and how far it is to the next, 0 to 1. */
interface Place {
  readonly step: number;
  readonly share: number;
}

/**
 * A path of the warping waits in one clip, then in the other: bodies that follow it stumble. What
 * is played is its mean over so many seconds before and after.
 */
const SMOOTH_SECONDS = 0.25;
const GRID_SECONDS = 0.05;
const HIPS = "hips";

/**
 * The common time of both clips: the mean of their times since the start of the path. It grows
 * with every step, and an exchange of the clips does not change it.
 */
export class Path {
  /** Seconds of the common time. */
  readonly seconds: number;
  /** (steps,) seconds of the common time. */
  readonly clock: readonly number[];
  /** (steps,) meters: the mean over the joints. The hips are left out: they never differ. */
  readonly means: readonly number[];
  readonly #smooth: readonly Times[];

  constructor(readonly alignment: Alignment) {
    const { path, joints, differences } = alignment;
    const start = middle(path[0]);
    this.clock = path.map((times) => middle(times) - start);
    this.seconds = this.clock.at(-1) ?? 0;
    const counted = joints.filter((joint) => joint !== HIPS).length;
    this.means = differences.map((step) => sum(step) / Math.max(1, counted));
    this.#smooth = this.#smoothed();
  }

  /** The times of both clips, seconds of their own. */
  timesAt(seconds: number): Times {
    const exact = Math.min(Math.max(0, seconds), this.seconds) / this.#grid;
    const before = Math.min(Math.floor(exact), this.#smooth.length - 1);
    const [from, to] = [this.#smooth[before], this.#smooth[before + 1]];
    return mixed(from ?? [0, 0], to ?? from ?? [0, 0], exact - before);
  }

  /** (joints,) meters. */
  differencesAt(seconds: number): readonly number[] {
    const { step, share } = this.#placeAt(seconds);
    const from = this.alignment.differences[step] ?? [];
    const to = this.alignment.differences[step + 1] ?? from;
    return from.map((value, joint) => value + share * ((to[joint] ?? value) - value));
  }

  /** Meters of one joint at every step. */
  differencesOf(joint: string): readonly number[] {
    const place = this.alignment.joints.findIndex((name) => name === joint);
    return this.alignment.differences.map((step) => step[place] ?? 0);
  }

  /** The common time at which the first clip is at a time of its own. */
  secondsAt(own: number): number {
    const step = this.alignment.path.findIndex(([first = 0]) => first >= own);
    return this.clock[step] ?? this.seconds;
  }

  /** The common time of the times of a peak. */
  secondsOf(times: readonly number[]): number {
    return middle(times) - middle(this.alignment.path[0]);
  }

  /** How many seconds longer the second clip has taken up to here. */
  laterAt(seconds: number): number {
    const [first = 0, second = 0] = this.alignment.path[0] ?? [];
    const [a, b] = this.timesAt(seconds);
    return b - second - (a - first);
  }

  get #grid(): number {
    const count = Math.max(1, Math.round(this.seconds / GRID_SECONDS));
    return this.seconds > 0 ? this.seconds / count : GRID_SECONDS;
  }

  #placeAt(seconds: number): Place {
    let [low, high] = [0, this.clock.length - 1];
    while (high - low > 1) {
      const half = (low + high) >> 1;
      if ((this.clock[half] ?? 0) <= seconds) low = half;
      else high = half;
    }
    const [from = 0, to = from] = [this.clock[low], this.clock[low + 1]];
    const share = to > from ? Math.min(Math.max(0, (seconds - from) / (to - from)), 1) : 0;
    return { step: low, share };
  }

  #exactTimesAt(seconds: number): Times {
    const { step, share } = this.#placeAt(seconds);
    const path = this.alignment.path;
    return mixed(pair(path[step]), pair(path[step + 1] ?? path[step]), share);
  }

  /** The times at a grid of common times; each is a mean over as many before as after it. */
  #smoothed(): Times[] {
    const grid = this.#grid;
    const count = Math.round(this.seconds / grid) + 1;
    const exact = Array.from({ length: count }, (_, place) => this.#exactTimesAt(place * grid));
    const reach = Math.round(SMOOTH_SECONDS / grid);
    return exact.map((_, place) => {
      const near = Math.min(reach, place, count - 1 - place);
      const some = exact.slice(place - near, place + near + 1);
      return [
        sum(some.map(([first]) => first)) / some.length,
        sum(some.map(([, second]) => second)) / some.length,
      ];
    });
  }
}

/** Seconds between two moments of a list, and how many it names at most: as `peaks` of the API. */
const MOMENT_SECONDS = 0.5;
const MAX_MOMENTS = 5;

/** The moments at which the joints agree most, the closest first: common time and meters. */
export function agreements(path: Path): readonly { seconds: number; meters: number }[] {
  const found: { seconds: number; meters: number }[] = [];
  const steps = path.clock.map((seconds, step) => ({ seconds, meters: path.means[step] ?? 0 }));
  for (const step of steps.toSorted((one, other) => one.meters - other.meters)) {
    const isNew = found.every(({ seconds }) => Math.abs(seconds - step.seconds) >= MOMENT_SECONDS);
    if (isNew) found.push(step);
    if (found.length === MAX_MOMENTS) break;
  }
  return found;
}

/** Joints by their mean difference, the greatest first; without the hips. */
export function ranked({ joints, mean_differences }: Alignment): readonly [string, number][] {
  return joints
    .map((joint, place): [string, number] => [joint, mean_differences[place] ?? 0])
    .filter(([joint]) => joint !== HIPS)
    .toSorted(([, one], [, other]) => other - one);
}

function pair([first = 0, second = 0]: readonly number[] = []): Times {
  return [first, second];
}

function middle(times: readonly number[] = []): number {
  const [first, second] = pair(times);
  return (first + second) / 2;
}

function mixed(from: Times, to: Times, share: number): Times {
  return [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
}

function sum(values: readonly number[]): number {
  return values.reduce((total, value) => total + value, 0);
}
