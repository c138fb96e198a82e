import { describe, expect, it } from "vitest";
import { choice, flag, list, number, readQuery, text, writeQuery } from "./query";

const SHAPE = {
  q: text(),
  person: list(),
  sort: choice(["new", "name"], "new"),
  loop: flag(true),
  t: number(null, 0, 10),
};

const read = (query: string) => readQuery(SHAPE, new URLSearchParams(query));

describe("the query of an address", () => {
  it("gives initial values where nothing is said", () => {
    expect(read("")).toEqual({ q: "", person: [], sort: "new", loop: true, t: null });
  });

  it("reads what it wrote", () => {
    const values = {
      q: "a&b=c",
      person: ["ada", "x y"],
      sort: "name",
      loop: false,
      t: 2.5,
    } as const;
    const written = writeQuery(SHAPE, new URLSearchParams(), values);
    expect(readQuery(SHAPE, written)).toEqual(values);
  });

  it("leaves initial values out, and parameters of others in", () => {
    const written = writeQuery(SHAPE, new URLSearchParams("q=x&other=1"), { q: "", sort: "name" });
    expect(written.toString()).toBe("other=1&sort=name");
  });

  it("counts what cannot be read as left out", () => {
    expect(read("sort=evil&t=11&loop=maybe")).toEqual(read(""));
    expect(read("t=NaN&t=1")).toEqual(read(""));
    expect(read("t=")).toEqual(read(""));
  });
});
