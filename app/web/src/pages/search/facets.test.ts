import { describe, expect, it } from "vitest";
import { readQuery } from "$/core/query";
import { SEARCH } from "./address";
import { countsOfClips, countsOfFacets, facetsOf, toggled, type Labeled } from "./facets";

const read = (address: string) => readQuery(SEARCH, new URLSearchParams(address));
const clip = (person: string, task: string | null, ...words: string[]): Labeled => ({
  person,
  task,
  words,
  source: null,
  license: "CC0-1.0",
});
const { counts: COUNTS } = countsOfClips([
  clip("ada", "kick", "leg"),
  clip("ada", "walk", "slow", "leg"),
  clip("bo", null, "leg"),
]);

describe("facets", () => {
  it("count each value, the most frequent first, where there is a choice", () => {
    const facets = facetsOf(COUNTS, read(""));
    expect(facets.map(({ name }) => name)).toEqual(["person", "task", "word"]);
    expect(facets[2]?.values).toEqual([
      { value: "leg", count: 3, state: "free" },
      { value: "slow", count: 1, state: "free" },
    ]);
  });

  it("are those that the API counts over all hits", () => {
    const of = (others: number, missing: number, values: Record<string, number>) => ({
      values: Object.entries(values).map(([value, count]) => ({ value, count })),
      others,
      missing,
      quartiles: null,
    });
    const { count, counts } = countsOfFacets({
      person: of(2, 1, { ada: 4, bo: 3 }),
      word: of(0, 0, { leg: 9, slow: 1 }),
    });
    expect(count).toBe(10);
    expect(facetsOf(counts, read("")).map(({ name }) => name)).toEqual(["person", "word"]);
  });

  it("keep what is chosen or left out, though no hit carries it", () => {
    const facets = facetsOf(COUNTS, read("task=jump&not_license=MIT"));
    expect(facets.find(({ name }) => name === "task")?.values[0]).toEqual({
      value: "jump",
      count: 0,
      state: "only",
    });
    expect(facets.find(({ name }) => name === "license")?.values[0]?.state).toBe("without");
  });

  it("a value is asked for alone, left out instead, and free again", () => {
    const chosen = read("task=kick&task=walk");
    const kick = { value: "kick", state: "only" } as const;
    expect(toggled(chosen, "task", kick, "only")).toEqual({ task: ["walk"], not_task: [] });
    expect(toggled(chosen, "task", kick, "without")).toEqual({
      task: ["walk"],
      not_task: ["kick"],
    });
  });
});
