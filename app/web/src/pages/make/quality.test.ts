import { describe, expect, it } from "vitest";
import type { Schemas } from "$/api/client";
import { inSentences } from "./quality";

const QUALITY = {
  kind: "new_task",
  given_persons: ["bo", "cy"],
  given_tasks: ["walk"],
  follows: null,
  nearest_person: "bo",
  nearest_task: "high_kick",
  person_is_right: false,
  task_is_right: true,
  expected_hit: 0.5,
  expected_trials: 8,
  real_hit: null,
  skate: 0.04,
  real_skate: 0.02,
  warnings: [],
} as unknown as Schemas["Quality"];

describe("the quality of a motion", () => {
  it("is said honestly", () => {
    const said = inSentences(QUALITY, "ada", "high_kick");
    expect(said[0]).toContain('2 persons who did "high kick", and of 1 task that ada did');
    expect(said[1]).toContain("the person is another");
    expect(said[2]).toContain("About 50 % of such motions");
    expect(said[3]).toContain("4 cm/s, in real takes 2 cm/s");
  });

  it("warns of a motion that is much jerkier than real takes", () => {
    const detail = "The motion is jerky: 900 m/s³, real takes of kick 200.";
    const jerky = { ...QUALITY, warnings: [{ code: "jerky", detail, value: 900, real: 200 }] };
    expect(inSentences(jerky, "ada", "kick").at(-1)).toBe(`Warning: ${detail}`);
  });

  it("warns of a motion that looks like another task", () => {
    const wrong = { ...QUALITY, task_is_right: false, expected_hit: null };
    expect(inSentences(wrong, "ada", "kick")[1]).toContain("Do not trust");
    expect(inSentences(wrong, "ada", "kick")).toHaveLength(3);
    expect(inSentences({ ...QUALITY, kind: "seen" }, "ada", "kick")[0]).toContain("ada did this");
  });
});
