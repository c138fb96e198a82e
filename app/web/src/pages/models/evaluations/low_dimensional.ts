/** The results of an evaluation of motions of few dimensions as blocks. */
import { label } from "$/core/format";
import { column, shares, type Block, type Point } from "./blocks";
import type { LowDimensionalDocument } from "./documents";

const BASES: Readonly<Record<string, string>> = {
  keypose: "keyposes",
  uniform: "uniform poses",
  all_frames: "all frames (the least)",
  original: "the motion itself",
};

export function lowDimensional(found: LowDimensionalDocument): Block[] {
  const bases = ["keypose", "uniform", "all_frames"];
  return [
    {
      type: "plot",
      title: "Error by the number of dimensions",
      note: `${found.clips} clips, each reduced by its own keyposes, or by as many uniform poses. ${found.left_out} others have too few keyposes.`,
      x: "dimensions",
      y: "mm",
      lines: bases.map((basis) => ({
        name: BASES[basis] ?? basis,
        points: found.dimensions.map((row): Point => [row.dimensions, row.error_mm[basis] ?? 0]),
      })),
    },
    {
      type: "table",
      title: "By dimensions",
      note: "Kept: the share of the variance of the model's own poses.",
      columns: [
        column("Dimensions", "count"),
        ...shares("Kept, keyposes", "Kept, uniform"),
        column("Keyposes", "mm"),
        column("Uniform", "mm"),
        column("All frames", "mm"),
        column("Keyposes better", "share"),
      ],
      rows: found.dimensions.map((row) => [
        row.dimensions,
        row.variance_kept.keypose ?? null,
        row.variance_kept.uniform ?? null,
        ...bases.map((basis) => row.error_mm[basis] ?? null),
        row.keypose_better,
      ]),
    },
    {
      type: "table",
      title: "Impossible poses at 3 dimensions",
      columns: [
        column("Made from", "text"),
        column("Frames", "count"),
        column("Impossible", "count"),
        column("Clustering", "number"),
      ],
      rows: found.poses.map((row) => [
        BASES[row.basis] ?? row.basis,
        row.frames,
        row.implausible,
        row.silhouette,
      ]),
    },
    ...(found.groups.length > 0
      ? [
          {
            type: "table",
            title: "Several persons in one model",
            columns: [
              column("Task", "text"),
              column("Persons", "count"),
              column("Poses", "count"),
              ...shares("Kept, keyposes", "Kept, uniform"),
              column("Keyposes", "mm"),
              column("Uniform", "mm"),
            ],
            rows: found.groups.map((row) => [
              label(row.task),
              row.persons,
              row.poses,
              row.variance_kept.keypose ?? null,
              row.variance_kept.uniform ?? null,
              row.error_mm.keypose ?? null,
              row.error_mm.uniform ?? null,
            ]),
          } as const,
        ]
      : []),
  ];
}
