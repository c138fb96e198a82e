import { expect, it } from "vitest";
import { extended, NONE, toggled } from "./selection";

const ORDER = ["a", "b", "c", "d", "e"];

it("toggles one, and extends from the last one", () => {
  const b = toggled(NONE, "b");
  const bToD = extended(b, "d", ORDER);
  expect([...bToD.ids]).toEqual(["b", "c", "d"]);
  expect([...extended(bToD, "a", ORDER).ids].sort()).toEqual(["a", "b", "c", "d"]);
  expect([...toggled(bToD, "c").ids]).toEqual(["b", "d"]);
});

it("takes one where the range has no beginning", () => {
  expect([...extended(NONE, "c", ORDER).ids]).toEqual(["c"]);
  expect([...extended(toggled(NONE, "gone"), "c", ORDER).ids].sort()).toEqual(["c", "gone"]);
});
