import { describe, expect, it } from "vitest";
import { drawn } from "./address";

describe("a draw of clips", () => {
  it("takes each at most once, and no more than there are", () => {
    expect(drawn(["a", "b", "c"], 2, () => 0.99)).toEqual(["c", "b"]);
    expect(drawn(["a", "b"], 5, () => 0)).toEqual(["a", "b"]);
  });
});
