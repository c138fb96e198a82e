/** The results of an evaluation of keyposes as blocks. */
import { label } from "$/core/format";
import { OURS } from "../figures";
import { column, shares, type Block, type Cell, type Point } from "./blocks";
import type { KeyposeDocument } from "./documents";

const METHOD = column("Method", "text");

const ENERGIES: Readonly<Record<string, string>> = {
  rms: OURS,
  printed: "Energy as printed (Perera)",
  "end-effectors": "Hands and feet",
};

export function keyposes(found: KeyposeDocument): Block[] {
  const methods = Object.entries(found.methods);
  const isHeldOut = found.recordings > 1;
  const groups = methods.flatMap(([method, { by_group: by = {} }]) =>
    Object.entries(by).map(([group, one]): Cell[] => [
      label(group),
      ENERGIES[method] ?? method,
      one.found,
      one.correct,
      one.precision,
      one.recall,
      one.f,
    ]),
  );
  const counted = [
    column("Found", "count"),
    column("Right", "count"),
    ...shares("Precision", "Recall", "F"),
  ];
  return [
    {
      type: "table",
      title: `Right within ${found.tolerance} s`,
      note: isHeldOut
        ? "Learned thresholds are those of the other recordings."
        : "A second recording is needed to judge learned thresholds.",
      columns: [METHOD, column("Thresholds", "text"), ...counted],
      rows: methods.flatMap(([method, one]) =>
        [
          ...(isHeldOut ? ([["learned", one.held_out]] as const) : []),
          ["usual", one.usual_thresholds] as const,
        ].map(([way, counts]) => [
          ENERGIES[method] ?? method,
          way,
          counts.found,
          counts.correct,
          counts.precision,
          counts.recall,
          counts.f,
        ]),
      ),
    },
    ...(groups.length > 0
      ? [
          {
            type: "table",
            title: "By group",
            columns: [column("Group", "text"), METHOD, ...counted],
            rows: groups,
          } as const,
        ]
      : []),
    ...methods.slice(0, 1).flatMap(([, one]) =>
      (["t1", "t2"] as const).map((name): Block => {
        const curve = one[`over_${name}`];
        const line = (values: readonly number[]): Point[] =>
          values.map((value, place) => [curve.values[place] ?? 0, value]);
        return {
          type: "plot",
          title: `By the threshold ${name.toUpperCase()}`,
          note: "The other threshold stays as learned.",
          x: name.toUpperCase(),
          y: "share",
          range: [0, 1],
          lines: [
            { name: "precision", points: line(curve.precision) },
            { name: "recall", points: line(curve.recall) },
          ],
        };
      }),
    ),
    ...(found.clips
      ? [
          {
            type: "table",
            title: "Clip by clip",
            columns: [
              column("Clip", "text"),
              column("True", "count"),
              ...methods.flatMap(([method]) => [
                column(`${ENERGIES[method] ?? method}: found`, "count"),
                column("right", "count"),
              ]),
            ],
            rows: found.clips.map((clip) => [
              clip.name,
              clip.true,
              ...methods.flatMap(([method]) => [
                clip.methods[method]?.found ?? null,
                clip.methods[method]?.correct ?? null,
              ]),
            ]),
            clipIds: found.clips.map((clip) => clip.clip_id),
          } as const,
        ]
      : []),
  ];
}
