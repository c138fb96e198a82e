import { describe, expect, it } from "vitest";
import type { Schemas } from "$/api/client";
import {
  errorCurve,
  largestConfusions,
  linePath,
  matrixOf,
  recognitionTable,
  wordTable,
} from "./figures";

const MODEL = {
  figures: {
    held_out: { default: { person: 0.9, task: 1 }, prior: { person: 0.1, task: 0.2, both: 0 } },
    unknown: {
      task: {
        curve: [
          { threshold: 2, false_acceptance: 0.5, false_rejection: 0.1 },
          { threshold: 1, false_acceptance: 0.1, false_rejection: 0.4 },
        ],
      },
    },
    figures: [{ method: "cca", top_3_recognition: 0.5, word_map: 0.25 }],
  },
} as unknown as Schemas["Model"];

describe("figures", () => {
  it("are rows of methods; what was not measured is null", () => {
    expect(recognitionTable(MODEL).rows[0]).toEqual({ method: "Kinedex", values: [0.9, 1, null] });
    expect(wordTable(MODEL).rows[0]?.values).toEqual([0.5, 0.25, null, null]);
    expect(wordTable({ figures: {} } as unknown as Schemas["Model"]).rows).toEqual([]);
  });

  it("are curves by false acceptance", () => {
    expect(errorCurve(MODEL, "task")).toEqual([
      [0.1, 0.4],
      [0.5, 0.1],
    ]);
    expect(errorCurve(MODEL, "person")).toEqual([]);
    expect(
      linePath(
        [
          [0, 0],
          [1, 1],
        ],
        10,
      ),
    ).toBe("M0.0 10.0L10.0 0.0");
  });
});

describe("the confusion matrix", () => {
  const matrix = matrixOf({
    factor: "task",
    names: ["hop", "kick"],
    items: [
      { label: "kick", guess: "kick", count: 3 },
      { label: "kick", guess: "hop", count: 1 },
    ],
    next: null,
  });

  it("has shares of each label's clips", () => {
    expect(matrix[1]?.map(({ share }) => share)).toEqual([0.25, 0.75]);
    expect(matrix[0]?.map(({ share }) => share)).toEqual([0, 0]);
  });

  it("lists the largest confusions", () => {
    expect(largestConfusions(matrix, 5).map(({ guess }) => guess)).toEqual(["hop"]);
  });
});
