import { expect, it } from "vitest";
import { colored } from "./stills";

const SVG =
  '<svg><rect width="320" height="180" fill="#f6f4ef"/><path d="M0 1" stroke="#c2622d"/></svg>';

it("a still has no paper, and colors of the theme", () => {
  expect(colored(SVG, false)).toBe('<svg><path d="M0 1" stroke="#c2622d"/></svg>');
  expect(colored(SVG, true)).toBe('<svg><path d="M0 1" stroke="#ee9463"/></svg>');
});
