import { expect, it } from "vitest";
import { partsOf } from "./path";

it("splits and decodes a path, whatever it holds", () => {
  expect(partsOf("/")).toEqual([]);
  expect(partsOf("/people/Ana%20%2F%20B/")).toEqual(["people", "Ana / B"]);
  expect(partsOf("/clips/%zz")).toEqual(["clips", "%zz"]);
});
