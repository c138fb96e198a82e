/** Draws a moving stick figure on a canvas. */
import type { Motion } from "./motion";
import { HEAD, HIPS, LINES } from "./roles";
import type { Side } from "./skeleton";
import { tokenColor } from "$/core/token";
import { along, offset, type View } from "./view";

export type Palette = Readonly<Record<Side | "ground", string>>;

/** Share of the canvas's height and width that stays free at each edge. */
const MARGIN = 0.08;
const HEAD_SIZE = 0.06;
const LINE_SIZE = 0.022;
const MARK_METERS = 0.5;

/** The colors of a figure where `element` stands: they follow the theme. */
export function paletteOf(element: Element): Palette {
  return {
    left: tokenColor(element, "--left"),
    right: tokenColor(element, "--right"),
    trunk: tokenColor(element, "--trunk"),
    ground: tokenColor(element, "--line"),
  };
}

/** The pose at a time in seconds, with the floor and marks on it that show how far it goes. */
export function drawPose(
  context: CanvasRenderingContext2D,
  motion: Motion,
  view: View,
  seconds: number,
  palette: Palette,
): void {
  const { width, height } = context.canvas;
  const frame = Math.min(Math.max(0, Math.round(seconds * motion.frameRate)), motion.frames - 1);
  const tall = view.top - view.floor || 1;
  const room = 1 - 2 * MARGIN;
  const scale = Math.min(
    (height * room) / (tall * (1 + HEAD_SIZE)),
    (width * room) / (view.right - view.left || 1),
  );
  const passed = view.follows ? along(motion, offset(motion, frame, HIPS), view.x, view.z) : 0;
  const middle = (view.left + view.right) / 2 + passed;
  const ground = height - MARGIN * height - (height * room - tall * scale) / 3;
  const point = (joint: number): [number, number] => {
    const at = offset(motion, frame, joint);
    const across = along(motion, at, view.x, view.z) - middle;
    return [
      width / 2 + across * scale,
      ground - ((motion.positions[at + 1] ?? 0) - view.floor) * scale,
    ];
  };

  context.clearRect(0, 0, width, height);
  context.lineCap = context.lineJoin = "round";
  drawGround(context, ground, middle, scale, palette.ground);
  context.lineWidth = LINE_SIZE * tall * scale;
  for (const { side, joints } of LINES) {
    context.strokeStyle = palette[side];
    context.beginPath();
    for (const joint of joints) context.lineTo(...point(joint));
    context.stroke();
  }
  context.fillStyle = palette.trunk;
  context.beginPath();
  context.arc(...point(HEAD), HEAD_SIZE * tall * scale, 0, 2 * Math.PI);
  context.fill();
}

function drawGround(
  context: CanvasRenderingContext2D,
  ground: number,
  middle: number,
  scale: number,
  color: string,
): void {
  const { width } = context.canvas;
  const first = Math.ceil((middle - width / 2 / scale) / MARK_METERS);
  const last = Math.floor((middle + width / 2 / scale) / MARK_METERS);
  context.strokeStyle = color;
  context.lineWidth = Math.max(1, width / 200);
  context.beginPath();
  context.moveTo(0, ground);
  context.lineTo(width, ground);
  for (let mark = first; mark <= last; mark += 1) {
    const x = width / 2 + (mark * MARK_METERS - middle) * scale;
    context.moveTo(x, ground);
    context.lineTo(x, ground + width / 60);
  }
  context.stroke();
}
