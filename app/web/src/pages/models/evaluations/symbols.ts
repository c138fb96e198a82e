/** The results of an evaluation of the symbol space as blocks. */
import { column, type Block, type Point } from "./blocks";
import type { SymbolsDocument } from "./documents";

export function symbols(found: SymbolsDocument): Block[] {
  const ways = [
    ["classical", "classical scaling"],
    ["smacof", "SMACOF"],
    ["s_stress", "the paper's own error"],
  ] as const;
  return [
    {
      type: "plot",
      title: "Error by the number of dimensions",
      note: `${found.symbols} motion symbols. The error T of a pair (Takano, eq. 3).`,
      x: "dimensions",
      y: "error of a pair",
      isLog: true,
      lines: ways.map(([way, name]) => ({
        name,
        points: found.errors.map((row): Point => [row.dimensions, row[way]]),
      })),
    },
    {
      type: "table",
      title: "By dimensions",
      columns: [
        column("Dimensions", "count"),
        ...ways.map(([, name]) => column(name, "number" as const)),
      ],
      rows: found.errors.map((row) => [row.dimensions, ...ways.map(([way]) => row[way])]),
    },
  ];
}
