import { expect, it } from "vitest";
import { readQuery, writeQuery } from "$/core/query";
import { askedFor, hitKey, isFiltered, query, scoped, SEARCH, UNFILTERED } from "./address";

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

it("a clip or a part of it is asked for before words", () => {
  expect(askedFor(read("clip=c1&q=wave&start=0.5&end=2&scope=windows&method=dtw"))).toEqual({
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
