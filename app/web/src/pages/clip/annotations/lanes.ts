/** The parts of a clip as lanes below its time line: where they stand, and how they are drawn. */
import { label } from "$/core/format";

export interface Part {
  readonly start: number;
  readonly end: number;
}

/** Seconds: no part that is drawn is shorter. */
export const SHORTEST = 0.1;

/** The lane of each part, from 0 on, so that none covers another; `parts` by start. */
export function lanesOf(parts: readonly Part[]): readonly number[] {
  const ends: number[] = [];
  return parts.map(({ start, end }) => {
    const free = ends.findIndex((last) => last <= start);
    const lane = free < 0 ? ends.length : free;
    ends[lane] = end;
    return lane;
  });
}

/** The part between two times, in milliseconds, within a clip; at least as long as SHORTEST. */
export function between(one: number, other: number, seconds: number): Part {
  const start = Math.max(0, Math.min(one, other, seconds - SHORTEST));
  const end = Math.min(seconds, Math.max(one, other, start + SHORTEST));
  return { start: milliseconds(start), end: milliseconds(end) };
}

/** A part with one end moved to a time; the other end stays. */
export function moved({ start, end }: Part, side: "start" | "end", to: number): Part {
  return side === "start"
    ? { start: milliseconds(Math.min(Math.max(0, to), end - SHORTEST)), end }
    : { start, end: milliseconds(Math.max(to, start + SHORTEST)) };
}

/** What is annotated next: the range that is played, else a second from the present time. */
export function nextPart(
  time: number,
  from: number | null,
  to: number | null,
  seconds: number,
): Part {
  if (from !== null || to !== null) return between(from ?? 0, to ?? seconds, seconds);
  return between(time, time + 1, seconds);
}

/** Rounds down, so that no end is behind the end of the clip. */
function milliseconds(value: number): number {
  return Math.floor(value * 1000 + 1e-6) / 1000;
}

/** What a part says, in short. */
export function textOf(one: {
  readonly words: readonly string[];
  readonly person?: string | null;
  readonly text?: string | null;
}): string {
  return one.words.map(label).join(", ") || one.text || one.person || "";
}

/** "0.50 to 2.00 s" */
export function timesOf({ start, end }: Part): string {
  return `${start.toFixed(2)} to ${end.toFixed(2)} s`;
}
