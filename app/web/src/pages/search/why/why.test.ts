import { expect, it } from "vitest";
import type { Schemas } from "$/api/client";
import {
  firstPart,
  hasReasons,
  highest,
  namedReasons,
  sharesOfCost,
  wordLines,
  type Explained,
} from "./why";

const reason = (part: string, others: Partial<Schemas["HitReason"]> = {}) => ({
  part,
  against: false,
  score: 0.5,
  cost: 1,
  weight: 1,
  alignment: null,
  curve: null,
  poses: null,
  cycles_per_minute: null,
  ...others,
});
const alignment = {} as Schemas["ExampleAlignment"];
const curve = { times: [0.5, 1.5, 2.5], values: [0.1, 0.9, 0.3] };
const explained = {
  reasons: {
    parts: [
      reason("examples.0", { alignment, against: true, cost: 0 }),
      reason("examples.1", { alignment, cost: 3 }),
      reason("words.0", { curve }),
      reason("words.1", { curve, against: true, cost: 0 }),
    ],
  },
  query: {
    examples: ["c1", "gone"].map((id) => ({ id, start: null, end: null, isAgainst: false })),
    words: ["wave", "-bow"],
    file: "",
  },
  clips: new Map([["c1", { id: "c1", name: "kick_01" }]]),
} as unknown as Explained;
const parts = namedReasons(explained);

it("names what is said, and has the clips of the examples that are there", () => {
  expect(parts.map(({ name }) => name)).toEqual(["kick_01", "gone", "wave", "bow"]);
  expect(parts.map(({ example }) => example?.id)).toEqual(["c1", undefined, undefined, undefined]);
});

it("shows an example for something first, else the first part", () => {
  expect(firstPart(parts)).toBe("examples.1");
  expect(firstPart(parts.slice(2))).toBe("words.0");
  expect(firstPart([])).toBe("");
});

it("divides what the parts cost", () => {
  expect(sharesOfCost(explained.reasons.parts)).toEqual([0, 0.75, 0.25, 0]);
  expect(sharesOfCost([{ cost: 0 }])).toEqual([0]);
});

it("draws a curve of each word, and finds its highest point", () => {
  const lines = wordLines(parts);
  expect(lines.map(({ name }) => name)).toEqual(["wave", "bow (against)"]);
  expect(highest(lines[0] ?? { name: "", points: [] })).toEqual([1.5, 0.9]);
});

it("parts of clips are explained for words only", () => {
  const common = { limit: 1 } as const;
  expect(hasReasons({ kind: "saved", id: "s", body: common })).toBe(true);
  const method = "fused" as const;
  const clip = { ...common, clip_id: "c1", method, scope: "windows" } as const;
  expect(hasReasons({ kind: "clip", body: clip })).toBe(false);
  expect(hasReasons({ kind: "clip", body: { ...clip, scope: "clips" } })).toBe(true);
});
