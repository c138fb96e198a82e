/** What is marked on the player's time line. */
import { api, ask } from "$/api/client";

export interface Span {
  readonly start: number;
  readonly end: number;
  readonly label: string;
}

export interface Keypose {
  readonly time: number;
  /** (13, 3) meters, in the order of ROLES. */
  readonly pose: readonly (readonly number[])[];
  readonly isNamed: boolean;
}

export interface Marks {
  readonly keyposes: readonly Keypose[];
  readonly beats: readonly number[];
  readonly segments: readonly Span[];
  /** Body lengths a second; one value a frame. */
  readonly energy: readonly number[];
  readonly energyRate: number;
  /** Other stretches of time, such as what a warning means or what a search found. */
  readonly spans?: readonly Span[];
}

/** The marks of a stored clip. Throws ApiProblem, Away. */
export async function marksOf(clipId: string, signal: AbortSignal): Promise<Marks> {
  const params = { path: { clip_id: clipId } };
  const [found, segments] = await Promise.all([
    ask(api.GET("/v1/clips/{clip_id}/keyposes", { params, signal })),
    ask(api.GET("/v1/clips/{clip_id}/segments", { params, signal })),
  ]);
  return {
    keyposes: found.times.map((time, place) => ({
      time,
      pose: found.poses[place] ?? [],
      isNamed: false,
    })),
    beats: found.beats,
    segments: segments.items.map(({ start, end, index, cycle }) => ({
      start,
      end,
      label: cycle === null ? `Segment ${index + 1}` : `Segment ${index + 1}, cycle ${cycle + 1}`,
    })),
    energy: found.energy.global,
    energyRate: found.frame_rate,
  };
}

/** Another clock: between the times of a clip and those of a player. */
export interface Clock {
  /** Of the player. */
  readonly seconds: number;
  /** Whether the player shows this time of the clip. */
  readonly isShown: (own: number) => boolean;
  readonly timeOf: (own: number) => number;
  readonly ownAt: (time: number) => number;
}

/** Frames a second of a curve on another clock. */
const CURVE_RATE = 30;

/** The marks of a clip that a player plays by another clock, or in part. */
export function retimed(marks: Marks, { seconds, isShown, timeOf, ownAt }: Clock): Marks {
  const moved = (span: Span): Span => ({
    ...span,
    start: timeOf(span.start),
    end: timeOf(span.end),
  });
  const within = (spans: readonly Span[]): readonly Span[] =>
    spans.filter(({ start, end }) => isShown(start) || isShown(end)).map(moved);
  const frames = Math.max(0, Math.ceil(seconds * CURVE_RATE));
  return {
    keyposes: marks.keyposes
      .filter(({ time }) => isShown(time))
      .map((keypose) => ({ ...keypose, time: timeOf(keypose.time) })),
    beats: marks.beats.filter(isShown).map(timeOf),
    segments: within(marks.segments),
    energy: Array.from(
      { length: frames },
      (_, frame) => marks.energy[Math.round(ownAt(frame / CURVE_RATE) * marks.energyRate)] ?? 0,
    ),
    energyRate: CURVE_RATE,
    ...(marks.spans && { spans: within(marks.spans) }),
  };
}

/** The name of a span, and where it is written. */
export interface Name {
  readonly text: string;
  /** Pixels: where it begins, or, in the second half, where it ends, so that it is not cut. */
  readonly x: number;
  readonly anchor: "start" | "end";
}

/** Pixels of a letter in the names of spans, about. */
const LETTER = 6.5;

/** The names that have room on a line `width` pixels wide; `x`: pixels at a time in seconds. */
export function namesOf(
  spans: readonly Span[],
  x: (seconds: number) => number,
  width: number,
): readonly Name[] {
  const taken: [number, number][] = [];
  return spans.flatMap(({ start, label }) => {
    const isLate = x(start) > width / 2;
    const long = LETTER * label.length;
    const [from, to] = isLate ? [x(start) - long, x(start)] : [x(start), x(start) + long];
    if (from < 0 || to > width || taken.some(([a, b]) => from < b && to > a)) return [];
    taken.push([from, to]);
    return [{ text: label, x: x(start), anchor: isLate ? ("end" as const) : ("start" as const) }];
  });
}

/** A curve as the path of an SVG of the given size; at most one point a pixel. */
export function curvePath(values: readonly number[], width: number, height: number): string {
  if (values.length < 2 || width <= 0) return "";
  const step = Math.max(1, Math.floor(values.length / width));
  const most = values.reduce((before, value) => Math.max(before, value), 0) || 1;
  const points: string[] = [];
  for (let place = 0; place < values.length; place += step) {
    const x = (place / (values.length - 1)) * width;
    const y = height * (1 - (values[place] ?? 0) / most);
    points.push(`${x.toFixed(1)} ${y.toFixed(1)}`);
  }
  return `M${points.join("L")}`;
}

/** A pose from the front as the path of an SVG, standing at (0, 0), `height` high; y goes down. */
export function posePath(
  pose: readonly (readonly number[])[],
  lines: readonly (readonly number[])[],
  height: number,
): string {
  const ys = pose.map((joint) => joint[1] ?? 0);
  const [floor, top] = [Math.min(...ys), Math.max(...ys)];
  const scale = height / (top - floor || 1);
  const hips = pose[4]?.[0] ?? 0;
  const point = (joint: number): string => {
    const [x = 0, y = 0] = pose[joint] ?? [];
    return `${((x - hips) * scale).toFixed(1)} ${((floor - y) * scale).toFixed(1)}`;
  };
  return lines.map((joints) => `M${joints.map(point).join("L")}`).join("");
}
