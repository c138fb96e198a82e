/** The results of an evaluation of words as blocks. */
import { label } from "$/core/format";
import { methodName } from "../figures";
import { column, shares, type Block, type Line, type Point } from "./blocks";
import type { WordRow, WordsDocument } from "./documents";

const METHOD = column("Method", "text");
const MAX_EXAMPLES = 4;

export function words(found: WordsDocument): Block[] {
  const curve = ({ method, precision }: WordRow): Line => ({
    name: methodName(method),
    points: precision
      .map((value, place): Point => [found.recalls[place] ?? 0, value])
      .filter(([recall]) => recall > 0),
  });
  const rare = found.by_word.filter((one) => one.too_rare).map((one) => label(one.word));
  return [
    wordRows(`Held out, in ${found.folds} parts`, found.figures),
    {
      type: "plot",
      title: "Clips for a word",
      note: "Of the clips that are found, how many are right, while more and more of the right ones are found.",
      x: "recall",
      y: "precision",
      range: [0, 1],
      lines: found.figures.map(curve),
    },
    {
      type: "table",
      title: "Word by word",
      ...(rare.length > 0 && {
        note: `Too rare to judge alone, in fewer than ${found.least_recordings} recordings: ${rare.join(", ")}.`,
      }),
      columns: [
        column("Word", "text"),
        column("Clips", "count"),
        column("Recordings", "count"),
        ...shares("AP", "F"),
        column("AUC", "number"),
      ],
      rows: found.by_word
        .filter((one) => !one.too_rare)
        .map((one) => [
          label(one.word),
          one.clips,
          one.recordings,
          one.average_precision,
          one.f,
          one.area_under_curve,
        ]),
    },
    wordRows("In-sample, as Takano's paper judged", found.in_sample),
    ...found.examples.slice(0, MAX_EXAMPLES).map((example): Block => ({
      type: "table",
      title: `Nearest to ${example.words.map(label).join(" ")}`,
      note: "In the correlated space as printed (Takano, table 2). Ratio: the distance, divided by that of the nearest clip.",
      columns: [
        column("Clip", "text"),
        column("Ratio", "number"),
        column("Has the word", "text"),
        column("Its words", "text"),
      ],
      rows: example.nearest.map((near) => [
        near.name,
        near.ratio,
        near.carries ? "yes" : "no",
        near.words.map(label).join(", "),
      ]),
      clipIds: example.nearest.map((near) => near.id),
    })),
  ];
}

function wordRows(title: string, rows: readonly WordRow[]): Block {
  return {
    type: "table",
    title,
    note: "MAP: mean average precision. F: where recall equals precision.",
    columns: [METHOD, ...shares("In the best 3", "Words, MAP", "Words, F", "Sets, MAP", "Sets, F")],
    rows: rows.map((row) => [
      methodName(row.method),
      row.top_3_recognition,
      row.word_map,
      row.word_f,
      row.set_map,
      row.set_f,
    ]),
  };
}
