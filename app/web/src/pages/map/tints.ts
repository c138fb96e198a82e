/** The colors of the points, in the tokens of the theme. */
import { between, rgb, type Rgb } from "$/core/color";
import { tokenColor } from "$/core/token";
import { MAX_CLASSES, NONE, OTHER, type Classes, type Range } from "./colors";
import type { Tints } from "./plot";

const OPAQUE = 235;
/** Of points without a value: they stand back. */
const FAINT = 110;
const RAMP = ["--ramp-1", "--ramp-2", "--ramp-3"];

/** `element`: where the map stands. */
export function tintsOf(colors: Classes | Range, element: Element): Tints {
  const token = (name: string): Rgb => rgb(tokenColor(element, name));
  const tints = new Uint8Array(colors.of.length * 4);
  const grey = token("--line-strong");
  if (colors.kind === "classes") {
    const table = Array.from({ length: MAX_CLASSES }, (_, place) => token(`--series-${place + 1}`));
    colors.of.forEach((place, index) => {
      const isFaint = place === OTHER || place === NONE;
      tints.set([...(table[place] ?? grey), isFaint ? FAINT : OPAQUE], index * 4);
    });
  } else {
    const ramp = RAMP.map(token);
    colors.of.forEach((share, index) => {
      const isKnown = !Number.isNaN(share);
      const color = isKnown ? between(ramp, share) : grey;
      tints.set([...color, isKnown ? OPAQUE : FAINT], index * 4);
    });
  }
  return tints;
}
