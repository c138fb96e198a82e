import { expect, it } from "vitest";
import { useful } from "./collect";

it("leaves out what systems put into folders", () => {
  const paths = ["a/walk.bvh", "a/.DS_Store", "__MACOSX/a/walk.bvh", "a/Thumbs.db", "b.c3d"];
  const found = paths.map((path) => ({ path, file: new File([], path) }));
  expect(useful(found).map(({ path }) => path)).toEqual(["a/walk.bvh", "b.c3d"]);
});
