import { describe, expect, it } from "vitest";
import type { Schemas } from "$/api/client";
import { following, queueQuery, stepped } from "./address";
import { accepting, proposals } from "./proposals";

const FOUND = {
  person: { label: null, known: false, score: 0.4, candidates: [{ label: "ada", score: 0.4 }] },
  task: { label: "kick", known: true, score: 0.9, candidates: [] },
  words: [
    { word: "leg", score: 0.8 },
    { word: "slow", score: 0.3 },
    { word: "tail", score: 0.01 },
  ],
} as unknown as Schemas["Recognition"];

describe("the queue", () => {
  it("asks for failed clips, for those with warnings, and for those that lack a label", () => {
    expect(queueQuery("failed", "task")).toMatchObject({ state: "failed" });
    expect(queueQuery("doubts", "task")).toMatchObject({ has_warnings: true });
    expect(queueQuery("unlabeled", "words")).toMatchObject({ missing: ["words"] });
  });

  it("steps and stops at its ends", () => {
    expect(stepped(["a", "b", "c"], "b", 1)).toBe("c");
    expect(stepped(["a", "b", "c"], "c", 1)).toBe("c");
    expect(stepped(["a", "b", "c"], "", -1)).toBe("a");
    expect(following(["a", "b", "c"], "b")).toBe("c");
    expect(following(["a", "b"], "b")).toBe("a");
    expect(following(["a"], "a")).toBe("");
  });
});

describe("proposals", () => {
  it("are what the clip lacks; a person who may be new is not likely", () => {
    const found = proposals(FOUND, { person: null, task: null, words: [] });
    expect(found.map(({ value, isLikely }) => [value, isLikely])).toEqual([
      ["kick", true],
      ["ada", false],
      ["leg", true],
      ["slow", false],
    ]);
    const others = proposals(FOUND, { person: "bo", task: "hop", words: ["leg"] });
    expect(others.map(({ value }) => value)).toEqual(["slow"]);
  });

  it("that are accepted are added to what the clip has", () => {
    const clip = { person: null, task: null, words: ["old"] };
    const likely = proposals(FOUND, clip).filter(({ isLikely }) => isLikely);
    expect(accepting(likely, clip)).toEqual({ task: "kick", words: ["old", "leg"] });
    expect(accepting([], clip)).toEqual({});
  });
});
