import { expect, it } from "vitest";
import { readQuery, writeQuery } from "$/core/query";
import {
  askedFor,
  examplesOf,
  hitKey,
  isAllAgainst,
  isFiltered,
  query,
  scoped,
  SEARCH,
  UNFILTERED,
  withExamples,
} from "./address";

const read = (address: string) => readQuery(SEARCH, new URLSearchParams(address));
const after = (address: string, changes: Parameters<typeof writeQuery<typeof SEARCH>>[2]) =>
  writeQuery(SEARCH, new URLSearchParams(address), changes).toString();

it("an empty address asks for nothing", () => {
  expect(askedFor(read(""))).toBeNull();
  expect(askedFor(read("task=walk&method=dtw"))).toBeNull();
});

it("words are asked for with their signs and the filters", () => {
  expect(askedFor(read("q=wave&q=-left&person=ada&mode=cca&n=48"))).toEqual({
    kind: "words",
    body: { words: ["wave", "-left"], mode: "cca", limit: 48, filter: { person: ["ada"] } },
  });
});

it("hits are arranged by the search for several parts, where they are whole clips", () => {
  const arranged = "group_by=person&diverse=1&least=0.5";
  expect(askedFor(read(`q=wave&${arranged}`))).toMatchObject({
    kind: "parts",
    body: { words: ["wave"], group_by: "person", diversity: 0.5, min_score: 0.5 },
  });
  expect(askedFor(read("clip=c1&least=0.5"))).toMatchObject({
    kind: "parts",
    body: { examples: [{ clip_id: "c1" }], min_score: 0.5 },
  });
  expect(askedFor(read(`q=wave&scope=windows&${arranged}`))).toMatchObject({ kind: "words" });
});

it("a clip or a part of it is asked for, also by older addresses", () => {
  expect(askedFor(read("clip=c1&start=0.5&end=2&scope=windows&method=dtw"))).toEqual({
    kind: "clip",
    body: {
      clip_id: "c1",
      start: 0.5,
      end: 2,
      scope: "windows",
      method: "dtw",
      limit: 24,
    },
  });
  expect(askedFor(read("ex=c1@0.5-2"))).toEqual(askedFor(read("clip=c1&start=0.5&end=2")));
});

it("the tempo counts where the method can tell", () => {
  const tempo = (address: string): unknown => {
    const asked = askedFor(read(address));
    return asked?.kind === "clip" ? asked.body.tempo : null;
  };
  expect(tempo("clip=c1")).toBeUndefined();
  expect(tempo("clip=c1&paced=1")).toBe("same");
  expect(tempo("clip=c1&paced=1&method=dtw")).toBeUndefined();
  expect(tempo("clip=c1&paced=1&scope=windows")).toBeUndefined();
});

it("several parts are asked for together", () => {
  expect(askedFor(read("clip=c1&start=0.5&ex=-c2@1-2&ex=@&q=wave&q=-left&task=walk"))).toEqual({
    kind: "parts",
    name: "",
    body: {
      examples: [
        { clip_id: "c1", start: 0.5, against: false },
        { clip_id: "c2", start: 1, end: 2, against: true },
      ],
      words: ["wave", "-left"],
      method: "fused",
      mode: "default",
      limit: 24,
      filter: { task: ["walk"] },
    },
  });
});

it("a file among several parts keeps its part", () => {
  expect(askedFor(read("file=a.bvh&ex=c1&start=1"))).toMatchObject({
    kind: "parts",
    name: "a.bvh",
    body: { examples: [{ clip_id: "c1", against: false }], start: 1, against: false },
  });
  expect(askedFor(read("file=a.bvh&less=1&q=wave"))).toMatchObject({
    kind: "parts",
    body: { words: ["wave"], against: true },
  });
  expect(isAllAgainst(read("file=a.bvh&less=1&q=-wave"))).toBe(true);
});

it("nothing is asked for where all is against something", () => {
  for (const address of ["ex=-c1", "ex=-c1&q=-wave", "ex=-c1&ex=-c2", "file=a.bvh&less=1"]) {
    expect(askedFor(read(address))).toBeNull();
    expect(isAllAgainst(read(address))).toBe(true);
  }
  for (const address of ["", "q=-wave", "ex=-c1&q=wave", "ex=-c1&file=a.bvh"]) {
    expect(isAllAgainst(read(address))).toBe(false);
  }
});

it("one example alone has the address of older links, several are listed", () => {
  const [c1, c2] = examplesOf(read("ex=c1@1-2&ex=-c2"));
  const to = (address: string, examples: readonly (typeof c1 | undefined)[]) =>
    after(
      address,
      withExamples(
        read(address),
        examples.filter((one) => one !== undefined),
      ),
    );
  expect(to("ex=-c2&hit=c3&n=48", [c1])).toBe("clip=c1&start=1&end=2");
  expect(to("clip=c1&start=1&end=2", [c1, c2])).toBe("ex=c1%401-2&ex=-c2");
  expect(to("clip=c1&pose=1.5", [c2])).toBe("ex=-c2");
  expect(to("file=a.bvh&start=1&ex=-c2", [c1])).toBe("ex=c1%401-2&file=a.bvh&start=1");
  expect(to("clip=c1&start=1&end=2", [])).toBe("");
});

it("a pose of a clip is asked for before its motion", () => {
  expect(askedFor(read("clip=c1&pose=1.5&task=walk"))).toEqual({
    kind: "pose",
    body: { clip_id: "c1", time: 1.5, limit: 24, filter: { task: ["walk"] } },
  });
  expect(after("clip=c1&pose=1.5", query({ clip: "c2" }))).toBe("clip=c2");
});

it("a file is asked for by its name only", () => {
  expect(askedFor(read("file=a.bvh"))).toMatchObject({ kind: "file", name: "a.bvh" });
});

it("another query keeps filters and method, and forgets the part and the hit", () => {
  const before = "clip=c1&start=1&end=2&hit=c2&t=0.5&task=walk&method=dtw";
  expect(after(before, query({ q: ["kick"] }))).toBe("q=kick&method=dtw&task=walk");
  expect(isFiltered(read(before))).toBe(true);
  expect(isFiltered(read(after(before, UNFILTERED)))).toBe(false);
});

it("another scope takes its default method where it has not the present one", () => {
  expect(after("clip=c1&method=metric-task", scoped("windows", "metric-task"))).toBe(
    "clip=c1&scope=windows",
  );
  expect(after("clip=c1&method=dtw", scoped("windows", "dtw"))).toContain("method=dtw");
});

it("a part of a clip is named by its start too", () => {
  const hit = { clip: { id: "c1" }, start: 1.5 } as Parameters<typeof hitKey>[0];
  expect(hitKey(hit, "clips")).toBe("c1");
  expect(hitKey(hit, "segments")).toBe("c1@1.5");
});
