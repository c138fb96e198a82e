/**
 * The points of the map, drawn with three.js: all of them, and the marked ones over them. Not with
 * regl-scatterplot: its regl writes its drawing code by `new Function`, which our policy forbids.
 */
import {
  BufferAttribute,
  BufferGeometry,
  OrthographicCamera,
  Points,
  Scene,
  ShaderMaterial,
  WebGLRenderer,
} from "three";
import { unitsOf, type Bounds, type Size, type View } from "./lens";

/** Red, green, blue and opacity of each point, 0 to 255, one after the other. */
export type Tints = Uint8Array;

export interface Marks {
  /** Indices of the points that are lit: the others fade. */
  readonly lit: readonly number[];
  /** Indices of the points that get a ring. */
  readonly ringed: readonly number[];
  /** Color of the rings: red, green, blue, 0 to 255. */
  readonly ring: readonly [number, number, number];
}

const MAX_PIXEL_RATIO = 2;
/** Opacity of points while others are lit. */
const FADED = 0.25;
/** Pixels of a marked point beyond the size of the others. */
const MARKED = 4;
const RING = 3;
/** Diameter in pixels for a number of points, and its growth with the zoom. */
const SIZES = [
  { points: 1_000, pixels: 9 },
  { points: 10_000, pixels: 6 },
  { points: 40_000, pixels: 4 },
  { points: Infinity, pixels: 3 },
] as const;
const GROWTH = 0.3;
const MAX_SIZE = 14;

const VERTEX = `
attribute vec4 tint;
uniform float size;
varying vec4 color;
void main() {
  color = tint;
  gl_PointSize = size;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;
const FRAGMENT = `
varying vec4 color;
uniform float opacity;
void main() {
  float away = length(gl_PointCoord - 0.5);
  float edge = smoothstep(0.5, 0.4, away);
  if (edge <= 0.0) discard;
  gl_FragColor = vec4(color.rgb, color.a * opacity * edge);
}`;

class Layer {
  readonly points: Points<BufferGeometry, ShaderMaterial>;

  constructor(order: number) {
    const material = new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: { size: { value: 1 }, opacity: { value: 1 } },
      transparent: true,
      depthTest: false,
      depthWrite: false,
    });
    this.points = new Points(new BufferGeometry(), material);
    this.points.frustumCulled = false;
    this.points.renderOrder = order;
  }

  set(name: "size" | "opacity", value: number): void {
    const uniform = this.points.material.uniforms[name];
    if (uniform) uniform.value = value;
  }

  /** Show the points (x, y) of these indices; all where there are none given. */
  fill(points: Float32Array, tints: Tints, indices?: readonly number[]): void {
    const count = indices?.length ?? points.length / 2;
    const positions = new Float32Array(count * 3);
    const colors = indices ? new Uint8Array(count * 4) : tints;
    for (let place = 0; place < count; place += 1) {
      const index = indices ? (indices[place] ?? 0) : place;
      positions[place * 3] = points[index * 2] ?? 0;
      positions[place * 3 + 1] = points[index * 2 + 1] ?? 0;
      if (indices) colors.set(tints.subarray(index * 4, index * 4 + 4), place * 4);
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.setAttribute("tint", new BufferAttribute(colors, 4, true));
    this.points.geometry.dispose();
    this.points.geometry = geometry;
  }

  dispose(): void {
    this.points.geometry.dispose();
    this.points.material.dispose();
  }
}

export class Plot {
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #camera = new OrthographicCamera(-1, 1, 1, -1, -1, 1);
  readonly #all = new Layer(0);
  readonly #rings = new Layer(1);
  readonly #marked = new Layer(2);
  readonly #ondraw: () => void;
  #count = 0;
  #request = 0;

  /** Throws without WebGL. */
  constructor(canvas: HTMLCanvasElement, ondraw: () => void) {
    this.#renderer = new WebGLRenderer({ canvas, alpha: true, powerPreference: "low-power" });
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, MAX_PIXEL_RATIO));
    this.#ondraw = ondraw;
    this.#scene.add(...this.#layers.map(({ points }) => points));
  }

  get #layers(): readonly Layer[] {
    return [this.#all, this.#rings, this.#marked];
  }

  show(points: Float32Array, tints: Tints, { lit, ringed, ring }: Marks): void {
    this.#count = points.length / 2;
    this.#all.fill(points, tints);
    this.#all.set("opacity", lit.length > 0 ? FADED : 1);
    const ringTints = new Uint8Array(tints.length);
    for (const index of ringed) ringTints.set([...ring, 255], index * 4);
    this.#rings.fill(points, ringTints, ringed);
    this.#marked.fill(points, tints, [...new Set([...lit, ...ringed])]);
  }

  look(view: View, bounds: Bounds, size: Size): void {
    const units = unitsOf(view, bounds, size);
    const [x, y] = view.middle;
    const [aside, above] = [(size.width / 2) * units, (size.height / 2) * units];
    Object.assign(this.#camera, {
      left: x - aside,
      right: x + aside,
      top: y + above,
      bottom: y - above,
    });
    this.#camera.updateProjectionMatrix();
    const pixels = this.sizeOf(view) * this.#renderer.getPixelRatio();
    this.#all.set("size", pixels);
    this.#marked.set("size", pixels + MARKED);
    this.#rings.set("size", pixels + MARKED + 2 * RING);
    this.draw();
  }

  /** Pixels of a point's diameter. */
  sizeOf({ zoom }: View): number {
    const { pixels } = SIZES.find(({ points }) => this.#count <= points) ?? SIZES[3];
    return Math.min(MAX_SIZE, pixels * Math.max(1, zoom) ** GROWTH);
  }

  resize({ width, height }: Size): void {
    this.#renderer.setSize(width, height, false);
  }

  /** Draw before the next frame, once however often it is called. */
  draw(): void {
    this.#request ||= requestAnimationFrame(() => {
      this.#request = 0;
      this.#renderer.render(this.#scene, this.#camera);
      this.#ondraw();
    });
  }

  dispose(): void {
    cancelAnimationFrame(this.#request);
    for (const layer of this.#layers) layer.dispose();
    this.#renderer.dispose();
  }
}
