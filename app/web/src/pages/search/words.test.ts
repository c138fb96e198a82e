import { expect, it } from "vitest";
import { withOtherSign, withoutWord, withWord } from "./words";

it("words are added once, with the sign that was typed last", () => {
  expect(withWord(["wave"], " -left hand ")).toEqual(["wave", "-left hand"]);
  expect(withWord(["wave", "kick"], "-wave")).toEqual(["kick", "-wave"]);
  expect(withWord(["wave"], " - ")).toEqual(["wave"]);
});

it("words change their sign in place, and leave", () => {
  expect(withOtherSign(["wave", "-left"], "left")).toEqual(["wave", "left"]);
  expect(withOtherSign(["wave", "left"], "wave")).toEqual(["-wave", "left"]);
  expect(withoutWord(["-wave", "left"], "wave")).toEqual(["left"]);
});
