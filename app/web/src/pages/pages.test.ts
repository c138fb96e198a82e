import { describe, expect, it } from "vitest";
import { OTHER_PAGES, PAGES, pageOf } from "./pages";

describe("the page of a path", () => {
  it("is found by the first part", () => {
    expect(pageOf(undefined)?.name).toBe("");
    expect(pageOf("search")?.name).toBe("search");
    expect(pageOf("nowhere")).toBeUndefined();
  });

  it("has a name of its own", () => {
    const names = [...PAGES, ...OTHER_PAGES].map((page) => page.name);
    expect(new Set(names).size).toBe(names.length);
  });
});
