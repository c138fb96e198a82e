import { expect, it } from "vitest";
import { readExample } from "./parts";
import { namedScores } from "./scores";

it("each score has the name of its part", () => {
  const examples = ["clip_1", "-clip_2@1-2"].map(readExample).filter((one) => one !== null);
  const query = { examples, words: ["wave", "-tired"], file: "a.bvh" };
  const names = new Map([["clip_1", "Walk"]]);
  const scores = [
    { part: "examples.0", against: false, score: 0.5 },
    { part: "examples.1", against: true, score: 0.25 },
    { part: "file", against: false, score: 1 },
    { part: "words.1", against: true, score: 0 },
    { part: "words.9", against: false, score: 0 },
  ];
  const found = namedScores(scores, query, (id) => names.get(id) ?? id);
  expect(found.map(({ name }) => name)).toEqual([
    "Walk",
    "clip_2, 1–2 s",
    "a.bvh",
    "tired",
    "words.9",
  ]);
  expect(found[1]).toMatchObject({ isAgainst: true, score: 0.25 });
});
