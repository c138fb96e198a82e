/** The floor: lines half a meter apart that fade with the distance from the middle. */
import {
  BufferGeometry,
  Color,
  Float32BufferAttribute,
  LineBasicMaterial,
  LineSegments,
} from "three";

const METERS_APART = 0.5;
/** Lines from the middle to each edge. */
const LINES = 24;
/** How many lines a piece crosses. */
const PIECE = 2;

export class Floor {
  readonly lines: LineSegments<BufferGeometry, LineBasicMaterial>;
  readonly #distances: readonly number[];

  // Each line is made of short pieces: they fade piece by piece, and software that draws no line
  // which reaches behind the camera leaves out a piece only.
  constructor() {
    const points: number[] = [];
    const distances: number[] = [];
    const add = (x: number, z: number): void => {
      points.push(x * METERS_APART, 0, z * METERS_APART);
      distances.push(Math.min(1, Math.hypot(x, z) / LINES));
    };
    for (let line = -LINES; line <= LINES; line += 1) {
      for (let piece = -LINES; piece < LINES; piece += PIECE) {
        const nearest = Math.min(Math.abs(piece), Math.abs(piece + PIECE));
        // What is farther has faded.
        if (Math.hypot(line, nearest) >= LINES) continue;
        add(line, piece);
        add(line, piece + PIECE);
        add(piece, line);
        add(piece + PIECE, line);
      }
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
    this.#distances = distances;
    this.lines = new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true }));
  }

  /** The color of the lines in the middle, and the one that they fade to. */
  color(near: string, far: string): void {
    const [from, to, mixed] = [new Color(near), new Color(far), new Color()];
    const colors = this.#distances.flatMap((share) => mixed.lerpColors(from, to, share).toArray());
    this.lines.geometry.setAttribute("color", new Float32BufferAttribute(colors, 3));
  }

  dispose(): void {
    this.lines.geometry.dispose();
    this.lines.material.dispose();
  }
}
