/** The results of an evaluation of recognition as blocks. */
import { label } from "$/core/format";
import { methodName } from "../figures";
import { column, shares, type Block, type Cell, type Line, type Point } from "./blocks";
import type { HeldOut, RecognitionDocument } from "./documents";

const METHOD = column("Method", "text");
const MAX_LINES = 5;

export function recognition(found: RecognitionDocument): Block[] {
  const { take } = found.left_out;
  const takes = Object.entries(found.takes_a_cell).map(([number, held]) =>
    recognized(`Learned from ${number} take${number === "1" ? "" : "s"} of each`, held),
  );
  return [
    ...(take ? [recognized("A fifth of the takes left out in turn", take)] : []),
    ...(take ? groupsOf(take) : []),
    ...(take ? matrices(take) : []),
    ...(["person", "task"] as const).flatMap((factor) => newOnes(factor, found.left_out[factor])),
    ...takes,
    ...told(found),
    {
      type: "table",
      title: "How long it takes",
      columns: [METHOD, column("To learn, s", "number"), column("For a clip, ms", "number")],
      rows: Object.entries(found.seconds).map(([method, { fit, probe }]) => [
        methodName(method),
        fit,
        probe * 1000,
      ]),
    },
    ...remarks("What could not be judged", found.not_judged),
  ];
}

function recognized(title: string, held: HeldOut): Block {
  const factors = ["task", "person", "both"] as const;
  const rows = Object.entries(held.methods).map(([method, { recognized: of }]): Cell[] => [
    methodName(method),
    ...factors.map((factor) => of[factor].share),
    of.task.of,
  ]);
  const chance: Cell[] = ["By chance", ...factors.map((factor) => held.chance[factor]), null];
  return {
    type: "table",
    title,
    note: "The share of clips whose best candidate is right. No method has seen the clips that it is judged on.",
    columns: [METHOD, ...shares("Task", "Person", "Both"), column("Trials", "count")],
    rows: [...rows, chance],
  };
}

function groupsOf(held: HeldOut): Block[] {
  const rows = Object.entries(held.methods).flatMap(([method, { by_group: groups = {} }]) =>
    Object.entries(groups).map(([group, of]): Cell[] => [
      label(group),
      methodName(method),
      of.task.share,
      of.person.share,
      of.task.of,
    ]),
  );
  if (rows.length === 0) return [];
  return [
    {
      type: "table",
      title: "By group",
      columns: [
        column("Group", "text"),
        METHOD,
        ...shares("Task", "Person"),
        column("Trials", "count"),
      ],
      rows,
    },
  ];
}

/** What the first method took clips for. */
function matrices(held: HeldOut): Block[] {
  const [first] = Object.entries(held.methods);
  if (!first) return [];
  return (["task", "person"] as const).flatMap((factor): Block[] => {
    const found = first[1].confusion?.[factor];
    if (!found || found.labels.length < 2) return [];
    const title = `What ${factor}s were taken for, by ${methodName(first[0])}`;
    return [{ type: "matrix", title, filter: factor, ...found }];
  });
}

function newOnes(factor: "person" | "task", held: HeldOut | undefined): Block[] {
  const found = Object.entries(held?.methods ?? {}).flatMap(([method, { unknown }]) => {
    const of = unknown[factor];
    return of ? [{ name: methodName(method), of }] : [];
  });
  if (found.length === 0) return [];
  const lines = found
    .filter(({ of }) => (of.curve ?? []).length > 0)
    .slice(0, MAX_LINES)
    .map(({ name, of }): Line => ({
      name,
      points: sorted(of.curve?.map((p) => [p.false_acceptance, p.false_rejection]) ?? []),
    }));
  return [
    {
      type: "table",
      title: `Is a new ${factor} called new?`,
      note: `Each ${factor} is left out in turn. AUC: the area under the curve below, 1 at best. Equal errors: the error where both are the same.`,
      columns: [
        METHOD,
        ...shares("New called new", "Known called known", "Mean of both"),
        column("AUC", "number"),
        column("Equal errors", "share"),
      ],
      rows: found.map(({ name, of }) => [
        name,
        of.refused.share,
        of.accepted.share,
        of.balanced_accuracy,
        of.area_under_curve,
        of.equal_error_rate,
      ]),
    },
    ...(lines.length > 0
      ? [
          {
            type: "plot",
            title: `Errors with new ${factor}s`,
            note: "Each method could be stricter or more lenient: its line shows both errors. Lower is better.",
            x: "new called known",
            y: "known called new",
            range: [0, 1],
            lines,
          } as const,
        ]
      : []),
  ];
}

function told({ told: found }: RecognitionDocument): Block[] {
  const rows = Object.entries(found).map(([method, one]): Cell[] => [
    methodName(method),
    one.neither.task.share,
    one.task_where_person_is_told.share,
    one.neither.person.share,
    one.person_where_task_is_told.share,
  ]);
  if (rows.length === 0) return [];
  return [
    {
      type: "table",
      title: "If the other label is told",
      columns: [METHOD, ...shares("Task", "Task, person told", "Person", "Person, task told")],
      rows,
    },
  ];
}

function remarks(title: string, reasons: Readonly<Record<string, string>>): Block[] {
  const lines = Object.entries(reasons).map(([name, reason]) => `${label(name)}: ${reason}`);
  return lines.length > 0 ? [{ type: "remarks", title, lines }] : [];
}

function sorted(points: readonly Point[]): Point[] {
  return points.toSorted(([one], [other]) => one - other);
}
