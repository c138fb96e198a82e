import { describe, expect, it } from "vitest";
import { changeShown, shown, type Block, type MatrixBlock, type TableBlock } from "./blocks";
import { bodyOf, KIND_NAMES, methodsOf, optionsText, type Form } from "./kinds";
import { blocksOf } from "./results";

const FORM: Form = {
  folder: "",
  by: "none",
  method: [],
  rate: null,
  nearest: null,
  queries: null,
  tolerance: null,
};
const share = (value: number | null, of = 10) => ({ share: value, of, interval_95: [0, 1] });
const recognized = { task: share(0.9), person: share(0.8), both: share(null, 0) };
const titles = (blocks: readonly Block[]): string[] => blocks.map(({ title }) => title);

describe("the body that starts an evaluation", () => {
  it("leaves out what was not changed", () => {
    for (const kind of KIND_NAMES) expect(bodyOf(kind, FORM)).toEqual({ kind });
  });

  it("leaves out options of other kinds", () => {
    const all: Form = {
      folder: "cmu",
      by: "task",
      method: ["fused", "prior"],
      rate: 0.1,
      nearest: 5,
      queries: 50,
      tolerance: 0.2,
    };
    const filter = { folder: "cmu" };
    expect(bodyOf("symbols", all)).toEqual({ kind: "symbols", filter });
    expect(bodyOf("retrieval", all)).toEqual({
      kind: "retrieval",
      filter,
      by: "task",
      methods: ["fused"],
      k: 5,
      max_queries: 50,
    });
    expect(bodyOf("recognition", all).methods).toEqual(["prior"]);
  });

  it("offers methods only where there is a choice", () => {
    expect(methodsOf("words")).toEqual([]);
    expect(methodsOf("retrieval")).toContain("fused");
  });

  it("is said in one line", () => {
    const options = { filter: { folder: ["cmu", "kit"] }, max_queries: 5 };
    expect(optionsText(options)).toBe("filter: folder cmu kit; max queries: 5");
  });
});

describe("values", () => {
  it("are shown in their unit", () => {
    expect(shown(0.1234, "share")).toBe("12.3 %");
    expect(shown(1234, "count")).toBe("1,234");
    expect(shown(12.34, "mm")).toBe("12.3 mm");
    expect(shown(0.00012, "number")).toBe("1.2e-4");
    expect(shown(null, "share")).toBe("–");
  });

  it("are compared with their sign", () => {
    expect(changeShown(0.9, 0.85, "share")).toBe("+5.0 points");
    expect(changeShown(10, 12.5, "mm")).toBe("−2.5 mm");
    expect(changeShown(0.5, 0.5, "share")).toBe("the same");
    expect(changeShown(0.5, 0.5001, "number")).toBe("−1.0e-4");
  });
});

describe("the results of recognition", () => {
  const judged = {
    recognized,
    unknown: {
      person: {
        refused: share(0.7),
        accepted: share(0.9),
        balanced_accuracy: 0.8,
        area_under_curve: 0.9,
        equal_error_rate: 0.2,
        curve: [
          { false_acceptance: 1, false_rejection: 0 },
          { false_acceptance: 0, false_rejection: 1 },
        ],
      },
    },
    confusion: {
      task: {
        labels: ["kick", "walk"],
        shares: [
          [1, 0],
          [0.5, 0.5],
        ],
      },
      person: { labels: ["ada"], shares: [[1]] },
    },
  };
  const held = { chance: { person: 0.5, task: 0.25, both: 0.1 }, methods: { default: judged } };
  const document = {
    left_out: { take: held, person: held },
    takes_a_cell: { "1": held },
    told: {},
    seconds: { default: { fit: 2, probe: 0.001 } },
    not_judged: { source: "Two sources are needed." },
  };
  const blocks = blocksOf("recognition", document);

  it("stand beside chance, with the number of trials", () => {
    const table = blocks[0] as TableBlock;
    expect(table.rows).toEqual([
      ["Kinedex", 0.9, 0.8, null, 10],
      ["By chance", 0.25, 0.5, 0.1, null],
    ]);
  });

  it("show matrices of two labels or more", () => {
    const matrices = blocks.filter(({ type }) => type === "matrix") as MatrixBlock[];
    expect(matrices.map(({ filter }) => filter)).toEqual(["task"]);
  });

  it("show the errors with new ones by false acceptance", () => {
    const plot = blocks.find(({ type }) => type === "plot");
    expect(plot).toMatchObject({
      lines: [
        {
          points: [
            [0, 1],
            [1, 0],
          ],
        },
      ],
    });
  });

  it("say what could not be judged, and what was too large to be kept", () => {
    expect(titles(blocks).at(-1)).toBe("What could not be judged");
    const trimmed = blocksOf("recognition", { ...document, trimmed: ["by_name"] });
    expect(trimmed[0]).toMatchObject({ lines: [expect.stringContaining("by name")] });
  });
});

describe("the results of keyposes", () => {
  const counts = { true: 4, found: 4, correct: 3, precision: 0.75, recall: 0.75, f: 0.75 };
  const curve = { values: [0, 1], precision: [1, 0.5], recall: [0, 1] };
  const method = { held_out: counts, usual_thresholds: counts, over_t1: curve, over_t2: curve };
  const document = { tolerance: 0.1, recordings: 1, clips: [], methods: { rms: method } };

  it("have no learned thresholds with one recording", () => {
    const [table] = blocksOf("keyposes", document) as TableBlock[];
    expect(table?.rows.map((row) => row[1])).toEqual(["usual"]);
    const [more] = blocksOf("keyposes", { ...document, recordings: 2 }) as TableBlock[];
    expect(more?.rows.map((row) => row[1])).toEqual(["learned", "usual"]);
  });
});
