/** The examples of a query: clips and parts of clips that hits are like, or are not like. */

export interface Example {
  readonly id: string;
  /** The part of the clip, seconds; null: its own start or end. */
  readonly start: number | null;
  readonly end: number | null;
  readonly isAgainst: boolean;
}

/** The API's limit. */
export const MAX_EXAMPLES = 20;

/** A minus, the id, and the part: `-clip_1@0.5-2`, `clip_1@0.5-`. */
const WRITTEN = /^(-?)([^@-][^@]*)(?:@(\d*\.?\d*)-(\d*\.?\d*))?$/;

/** The example in a text of the address; null where it cannot be read. */
export function readExample(written: string): Example | null {
  const [, minus, id, start, end] = WRITTEN.exec(written) ?? [];
  if (!id) return null;
  return { id, start: seconds(start), end: seconds(end), isAgainst: minus === "-" };
}

export function writeExample({ id, start, end, isAgainst }: Example): string {
  const part = start === null && end === null ? "" : `@${start ?? ""}-${end ?? ""}`;
  return `${isAgainst ? "-" : ""}${id}${part}`;
}

function seconds(written: string | undefined): number | null {
  const value = Number(written);
  return written && Number.isFinite(value) ? value : null;
}

/** Names an example among others: the same clip may be one twice, by different parts. */
export function keyOf(example: Example): string {
  return writeExample({ ...example, isAgainst: false });
}

/** With an example more; one that is there already gets the new sign. */
export function withExample(examples: readonly Example[], added: Example): readonly Example[] {
  const isThere = examples.some((one) => keyOf(one) === keyOf(added));
  if (!isThere) return [...examples, added];
  return examples.map((one) => (keyOf(one) === keyOf(added) ? added : one));
}

export function withoutExample(examples: readonly Example[], gone: Example): readonly Example[] {
  return examples.filter((one) => keyOf(one) !== keyOf(gone));
}

/** A part of a clip as people read it; empty for the whole clip. */
export function partText({ start, end }: Pick<Example, "start" | "end">): string {
  if (start === null && end === null) return "";
  if (end === null) return `from ${start} s`;
  return `${start ?? 0}–${end} s`;
}
