/** The results of an evaluation of search by example as blocks. */
import { label } from "$/core/format";
import { OURS } from "../figures";
import { column, shares, type Block } from "./blocks";
import type { RetrievalDocument } from "./documents";

const METHOD = column("Method", "text");

const SEARCHES: Readonly<Record<string, string>> = {
  fused: OURS,
  vector: "Motion vectors",
  dtw: "Time warping",
};

export function retrieval(found: RetrievalDocument): Block[] {
  const rates = found.true_positive_rates;
  const groups = Object.values(found.by_group ?? {}).flatMap((by) => Object.entries(by));
  const { unlabeled, alone } = found.left_out;
  const left = [
    ...(unlabeled > 0 ? [`${unlabeled} clips carry no task and were left out.`] : []),
    ...(alone > 0 ? [`${alone} clips are the only recording of their task.`] : []),
  ];
  return [
    {
      type: "table",
      title: "Clips of the same task among the nearest",
      note: `Each clip searches among ${rates.mixture}. MAP: mean average precision, 100 % if all clips of the task come first.`,
      columns: [
        METHOD,
        ...shares("The nearest", "Of the nearest 4", "Of the nearest 20", "MAP"),
        column("Queries", "count"),
      ],
      rows: found.figures.map((row) => [
        searchName(row.method),
        row.nearest,
        row.precision_at_4,
        row.precision_at_20,
        row.mean_average_precision,
        row.queries,
      ]),
    },
    ...(groups.length > 0
      ? [
          {
            type: "table",
            title: "By group",
            columns: [
              column("Group", "text"),
              METHOD,
              ...shares("The nearest", "Of the nearest 4", "MAP"),
              column("Queries", "count"),
            ],
            rows: groups.map(([group, row]) => [
              label(group),
              searchName(row.method),
              row.nearest,
              row.precision_at_4,
              row.mean_average_precision,
              row.queries,
            ]),
          } as const,
        ]
      : []),
    {
      type: "table",
      title: `Found among the ${rates.k} nearest`,
      note: "The largest tasks, hidden among all clips (Sun 2011, table 1).",
      columns: [METHOD, ...shares(...rates.classes.map(label), "All")],
      rows: Object.entries(rates.methods).map(([method, of]) => [
        searchName(method),
        ...rates.classes.map((name) => of[name] ?? null),
        of.overall ?? null,
      ]),
    },
    ...Object.entries(found.confusion?.methods ?? {})
      .slice(0, 1)
      .map(([method, of]): Block => ({
        type: "matrix",
        title: `Tasks of the nearest clips, by ${searchName(method)}`,
        filter: "task",
        labels: found.confusion?.classes ?? [],
        shares: of,
      })),
    ...(left.length > 0
      ? [{ type: "remarks", title: "What was left out", lines: left } as const]
      : []),
  ];
}

function searchName(method: string): string {
  return SEARCHES[method] ?? method.replace("msv-", "MSV ").replace("metric-", "learned metric, ");
}
