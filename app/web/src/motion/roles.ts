/** The 13 joints of `joints=roles`, in their order (Sun's figure 2). */
import type { Side } from "./skeleton";

export const ROLES = [
  "left_knee",
  "right_knee",
  "left_foot",
  "right_foot",
  "hips",
  "left_elbow",
  "right_elbow",
  "left_shoulder",
  "right_shoulder",
  "neck",
  "head",
  "left_hand",
  "right_hand",
] as const;

export const HIPS = ROLES.indexOf("hips");
export const HEAD = ROLES.indexOf("head");

/** Lines of a stick figure through the joints; the left side is drawn first. */
export const LINES: readonly { side: Side; joints: readonly number[] }[] = [
  line("left", "hips", "left_knee", "left_foot"),
  line("left", "neck", "left_shoulder", "left_elbow", "left_hand"),
  line("trunk", "hips", "neck", "head"),
  line("right", "hips", "right_knee", "right_foot"),
  line("right", "neck", "right_shoulder", "right_elbow", "right_hand"),
];

function line(side: Side, ...names: (typeof ROLES)[number][]) {
  return { side, joints: names.map((name) => ROLES.indexOf(name)) };
}
