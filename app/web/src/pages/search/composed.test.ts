import { describe, expect, it } from "vitest";
import { readQuery } from "$/core/query";
import { queryOf, SEARCH } from "./address";
import { composedOfGiven, isForSomething, isOfWholeClips, partsOf } from "./composed";

const asked = (address: string) => {
  const found = queryOf(readQuery(SEARCH, new URLSearchParams(address)));
  if (!found || found.kind === "saved" || found.kind === "fresh") throw new Error(address);
  return found;
};

describe("a query by several parts", () => {
  it("is made of a query of any kind, without its page", () => {
    expect(composedOfGiven(asked("q=wave&q=-left&task=kick"))).toEqual({
      words: ["wave", "-left"],
      mode: "default",
      filter: { task: ["kick"] },
    });
    expect(composedOfGiven(asked("clip=c1&start=1&method=dtw&paced=1"))).toEqual({
      examples: [{ clip_id: "c1", start: 1 }],
      method: "dtw",
    });
    expect(composedOfGiven(asked("clip=c1&pose=2"))).toEqual({
      poses: { sequence: [{ clip_id: "c1", time: 2 }] },
    });
    expect(composedOfGiven(asked("file=a.bvh&end=2"))).toEqual({ method: "fused", end: 2 });
  });

  it("has the parts that its answer names", () => {
    const { examples, words } = partsOf(composedOfGiven(asked("ex=c1&ex=-c2@1-2&q=wave")), "");
    expect(examples.map(({ id, end }) => [id, end])).toEqual([
      ["c1", null],
      ["c2", 2],
    ]);
    expect(words).toEqual(["wave"]);
  });

  it("is for something", () => {
    expect(isForSomething(asked("q=-wave&q=kick"))).toBe(true);
    expect(isForSomething(asked("q=-wave&q=-kick"))).toBe(false);
  });

  it("finds whole clips only", () => {
    expect(isOfWholeClips(asked("clip=c1"))).toBe(true);
    expect(isOfWholeClips(asked("q=wave&scope=windows"))).toBe(false);
  });
});
