import { expect, it } from "vitest";
import { readQuery, writeQuery } from "$/core/query";
import { clipQuery, GALLERY, isFiltered, UNFILTERED } from "./address";

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

it("asks for all clips by itself, and after clearing", () => {
  expect(clipQuery(read(""))).toEqual({ sort: "-created_at" });
  const cleared = writeQuery(GALLERY, new URLSearchParams("word=a&max=3&size=s"), UNFILTERED);
  expect(cleared.toString()).toBe("size=s");
});
