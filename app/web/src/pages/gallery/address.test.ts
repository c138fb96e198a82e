import { expect, it } from "vitest";
import { readQuery, writeQuery } from "$/core/query";
import {
  clipQuery,
  GALLERY,
  isFiltered,
  metadataParts,
  readBounds,
  UNFILTERED,
  withBounds,
} from "./address";

const read = (query: string) => readQuery(GALLERY, new URLSearchParams(query));

it("asks for what the address says", () => {
  const values = read("person=ada&person=bo&q=+kick+&state=ready&min=2&sort=name&size=l");
  expect(clipQuery(values)).toEqual({
    sort: "name",
    q: "kick",
    person: ["ada", "bo"],
    state: "ready",
    min_duration: 2,
  });
  expect(isFiltered(values)).toBe(true);
});

it("asks for measures", () => {
  const values = read("min=1&speed_min=0.5&speed_max=2&tempo_max=120&joints_min=x&sort=-speed");
  expect(clipQuery(values)).toEqual({
    sort: "-speed",
    min_duration: 1,
    min_speed: 0.5,
    max_speed: 2,
    max_tempo: 120,
  });
  const cleared = writeQuery(GALLERY, new URLSearchParams("speed_min=1&max=2"), UNFILTERED);
  expect(cleared.toString()).toBe("");
});

it("asks for all clips by itself, and after clearing", () => {
  expect(clipQuery(read(""))).toEqual({ sort: "-created_at" });
  const cleared = writeQuery(GALLERY, new URLSearchParams("word=a&max=3&size=s"), UNFILTERED);
  expect(cleared.toString()).toBe("size=s");
});

it("asks for metadata, for what clips lack, and for doubts", () => {
  const values = read("meta=age%3D30&meta=age%3D31&meta=take%3Da%3Db&lacks=task&doubts=1");
  expect(clipQuery(values)).toEqual({
    sort: "-created_at",
    "meta.age": ["30", "31"],
    "meta.take": ["a=b"],
    missing: ["task"],
    has_warnings: true,
  });
  expect(metadataParts("take=a=b")).toEqual(["take", "a=b"]);
});

it("asks for the measures that the library names, and for their order", () => {
  const values = read("measure=foot_skate::0.1&measure=dominance:-0.5:&measure=x&sort=-foot_skate");
  expect(clipQuery(values)).toEqual({
    sort: "-foot_skate",
    "measure.foot_skate.max": 0.1,
    "measure.dominance.min": -0.5,
  });
  expect(isFiltered(values)).toBe(true);
  expect(read("sort=a b").sort).toBe("-created_at");
  const bounds = { name: "jitter", least: 1, largest: null };
  expect(withBounds(["turn:1:", "jitter:0:2"], bounds)).toEqual(["turn:1:", "jitter:1:"]);
  expect(withBounds(["jitter:0:2"], { ...bounds, least: null })).toEqual([]);
  expect(readBounds("jitter::")).toBeNull();
});
