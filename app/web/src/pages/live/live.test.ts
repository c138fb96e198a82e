import { describe, expect, it } from "vitest";
import { jobTitle, summary } from "./address";

describe("a job", () => {
  it("says in few words what it was and did", () => {
    expect(jobTitle("fit")).toBe("Fit of the models");
    expect(summary({ total: 5, new: 3, failed: 2, skipped: 0 })).toBe("3 new, 2 failed");
    expect(summary(null)).toBe("");
  });
});
