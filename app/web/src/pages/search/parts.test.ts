import { expect, it } from "vitest";
import {
  keyOf,
  partText,
  readExample,
  withExample,
  withoutExample,
  writeExample,
  type Example,
} from "./parts";

const example = (changes: Partial<Example> = {}): Example => ({
  id: "clip_1",
  start: null,
  end: null,
  isAgainst: false,
  ...changes,
});

it.each([
  ["clip_1", example()],
  ["-clip_1", example({ isAgainst: true })],
  ["clip_1@0.5-1.5", example({ start: 0.5, end: 1.5 })],
  ["-clip_1@0.5-", example({ start: 0.5, isAgainst: true })],
  ["clip_1@-2", example({ end: 2 })],
])("%s is read and written", (written, read) => {
  expect(readExample(written)).toEqual(read);
  expect(writeExample(read)).toBe(written);
});

it.each(["", "-", "@1-2", "clip_1@x-2", "clip_1@1", "clip_1@1-2-3"])(
  "%j is no example",
  (written) => {
    expect(readExample(written)).toBeNull();
  },
);

it("an example that is there already gets the new sign and keeps its place", () => {
  const both = withExample([example()], example({ id: "clip_2" }));
  expect(both.map(({ id }) => id)).toEqual(["clip_1", "clip_2"]);
  const signed = withExample(both, example({ isAgainst: true }));
  expect(signed.map(writeExample)).toEqual(["-clip_1", "clip_2"]);
});

it("two parts of one clip are two examples", () => {
  const some = withExample([example()], example({ start: 1, end: 2 }));
  expect(some.map(keyOf)).toEqual(["clip_1", "clip_1@1-2"]);
  expect(withoutExample(some, example({ isAgainst: true })).map(keyOf)).toEqual(["clip_1@1-2"]);
});

it("parts are named by their seconds", () => {
  expect(partText(example())).toBe("");
  expect(partText(example({ start: 0.5, end: 2 }))).toBe("0.5–2 s");
  expect(partText(example({ start: 0.5 }))).toBe("from 0.5 s");
  expect(partText(example({ end: 2 }))).toBe("0–2 s");
});
