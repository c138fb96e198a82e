import { expect, it } from "vitest";
import { Kept } from "./kept";

it("keeps what was used last", () => {
  const gone: number[] = [];
  const kept = new Kept<string, number>(2, (value) => gone.push(value));
  kept.set("a", 1);
  kept.set("b", 2);
  kept.get("a");
  kept.set("c", 3);
  expect([kept.get("a"), kept.get("b"), kept.get("c")]).toEqual([1, undefined, 3]);
  expect(gone).toEqual([2]);
});
