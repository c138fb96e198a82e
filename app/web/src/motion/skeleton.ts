/** Which side of the body a joint belongs to, by its name, whatever tool made the skeleton. */
export type Side = "left" | "right" | "trunk";

const LEFT = /(^|[^a-z])(left|l)([^a-z]|$)|left/i;
const RIGHT = /(^|[^a-z])(right|r)([^a-z]|$)|right/i;
/** lFoot, LFoot, and the names of Acclaim's skeletons: lfemur. */
const SHORT =
  /^(?:[lr](?=[A-Z]|(?:hipjoint|femur|tibia|foot|toes|clavicle|humerus|radius|wrist|hand|fingers|thumb)$)|[LR](?=[A-Z][a-z]))/;

export function sideOf(name: string): Side {
  const short = SHORT.exec(name)?.[0];
  if (short) return short.toLowerCase() === "l" ? "left" : "right";
  if (LEFT.test(name)) return "left";
  return RIGHT.test(name) ? "right" : "trunk";
}

/** The name of the joint on the other side; the same name for the trunk. */
export function mirrored(name: string): string {
  const swaps: readonly [RegExp, (found: string) => string][] = [
    [/left|right/i, (found) => cased(found, found.toLowerCase() === "left" ? "right" : "left")],
    [/(?<![a-z])[lr](?![a-z])/i, (found) => cased(found, found.toLowerCase() === "l" ? "r" : "l")],
    [SHORT, (found) => cased(found, found.toLowerCase() === "l" ? "r" : "l")],
  ];
  const swap = swaps.find(([pattern]) => pattern.test(name));
  return swap ? name.replace(swap[0], swap[1]) : name;
}

/** `text` written like `model`: LEFT, Left or left. */
function cased(model: string, text: string): string {
  if (model === model.toUpperCase()) return text.toUpperCase();
  const isTitle = model.charAt(0) === model.charAt(0).toUpperCase();
  return isTitle ? text.charAt(0).toUpperCase() + text.slice(1) : text;
}
