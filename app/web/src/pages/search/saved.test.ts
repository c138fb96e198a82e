import { describe, expect, it } from "vitest";
import { readQuery } from "$/core/query";
import { askedFor, queryOf, SEARCH } from "./address";
import { isSameQuery, keptOf, valuesOf } from "./saved";

const read = (address: string) => readQuery(SEARCH, new URLSearchParams(address));
const kept = (address: string) => keptOf(queryOf(read(address)));

describe("a saved search", () => {
  it.each([
    "q=wave&q=-left&task=kick&not_person=ada",
    "clip=c1&start=0.5&method=dtw",
    "ex=c1&ex=-c2@1-2&q=wave",
    "q=wave&group_by=person&diverse=1&least=0.5",
  ])("says the same query when it comes back: %s", (address) => {
    const query = kept(address);
    const back = valuesOf(query ?? {});
    const again = keptOf(queryOf({ ...read(""), ...back }));
    expect(query).not.toBeNull();
    expect(isSameQuery(query ?? {}, again ?? {})).toBe(true);
    expect(isSameQuery(query ?? {}, kept("q=kick") ?? {})).toBe(false);
  });

  it("is no pose, no file, and no search for parts of clips", () => {
    expect(kept("clip=c1&pose=1")).toBeNull();
    expect(kept("file=a.bvh")).toBeNull();
    expect(kept("q=wave&scope=windows")).toBeNull();
    expect(kept("clip=c1&paced=1")).toBeNull();
  });

  it("that the page cannot say is asked for by its id", () => {
    expect(valuesOf({ words: ["wave"], filter: { min_speed: 1 } })).toBeNull();
    expect(valuesOf({ examples: [{ clip_id: "c1", weight: 2 }] })).toBeNull();
    expect(askedFor(read("saved=s1"))).toEqual({ kind: "saved", id: "s1", body: { limit: 24 } });
    expect(askedFor(read("saved=s1&q=wave"))).toMatchObject({ kind: "words" });
    expect(askedFor(read("saved=s1&q=wave&fresh=1"))).toEqual({ kind: "fresh", id: "s1" });
  });
});
