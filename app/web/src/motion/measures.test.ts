import { expect, it } from "vitest";
import { measured, titleOf } from "./measures";

it("measures are read with their units", () => {
  expect(measured("speed", 1.4217)).toBe("1.42 m/s");
  expect(measured("joints", 31)).toBe("31");
  expect(measured("tempo", null)).toBeNull();
  expect(titleOf("travel")).toBe("Way, m");
  expect(titleOf("joints")).toBe("Joints");
});
