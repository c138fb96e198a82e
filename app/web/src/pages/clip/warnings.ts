/** Where a clip is doubtful, in words and as marks of the time line. */
import type { Clip } from "$/api/client";
import { label } from "$/core/format";
import type { Span } from "$/player/marks";

export type Warning = Clip["warnings"][number];

/** "0.40 – 0.49 s, LeftKnee"; empty where the doubt is about the whole clip. */
export function placeOf({ start, end, joint }: Warning): string {
  const times = [start, end]
    .filter((time) => typeof time === "number")
    .map((time) => time.toFixed(2));
  const time = [...new Set(times)].join(" – ");
  return [time && `${time} s`, joint].filter(Boolean).join(", ");
}

/** The doubts that have a time, as spans with their names. */
export function spansOf(warnings: readonly Warning[]): readonly Span[] {
  return warnings.flatMap(({ code, joint, start, end }) =>
    typeof start !== "number"
      ? []
      : [{ start, end: end ?? start, label: [label(code), joint].filter(Boolean).join(": ") }],
  );
}
