import { describe, expect, it } from "vitest";
import type { Clip } from "$/api/client";
import { patchFor, undoing, words } from "./changes";

const CLIP = {
  id: "a",
  person: "ada",
  task: null,
  words: ["kick", "slow"],
  metadata: { take: 1 },
} as unknown as Clip;

describe("labels of many clips", () => {
  it("change only what differs, and can be taken back", () => {
    const patch = patchFor(CLIP, { person: "ada", task: "kick", add: ["kick"], remove: ["slow"] });
    expect(patch).toEqual({ task: "kick", words: ["kick"] });
    expect(undoing(CLIP, patch)).toEqual({ task: null, words: ["kick", "slow"] });
  });

  it("are left alone where nothing is said, and forgotten where none is wanted", () => {
    expect(patchFor(CLIP, { add: [], remove: [] })).toEqual({});
    expect(patchFor(CLIP, { person: null, add: [], remove: [] })).toEqual({ person: null });
  });

  it("are words as people type them", () => {
    expect(words(" left_leg, kick  high,")).toEqual(["left_leg", "kick", "high"]);
  });
});
