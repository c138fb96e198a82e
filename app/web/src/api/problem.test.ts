import { describe, expect, it } from "vitest";
import { ApiProblem, Away, inWords, problemOf } from "./problem";

const PROBLEM = {
  type: "urn:kinedex:problem:bad_field",
  title: "A field is wrong",
  status: 422,
  detail: "A field is wrong.",
  code: "bad_field",
  errors: [{ location: "body.frame_rate", message: "must be at least 1" }],
};

describe("problems in words", () => {
  it("say the detail and each place", () => {
    const problem = problemOf(PROBLEM, 422);
    expect(problem.code).toBe("bad_field");
    expect(inWords(problem)).toEqual(["A field is wrong.", "frame rate: must be at least 1"]);
  });

  it("are made of the status where an answer holds none", () => {
    expect(problemOf("<html>", 502)).toBeInstanceOf(ApiProblem);
    expect(inWords(problemOf(undefined, 502))).toEqual(["Kinedex answered with the status 502."]);
  });

  it("say that the service is away", () => {
    expect(inWords(new Away())).toEqual(["Kinedex does not answer."]);
  });
});
