/** The scene of the player: bodies on a floor, light, and a camera that turns around them. */
import {
  Color,
  DirectionalLight,
  Euler,
  HemisphereLight,
  MathUtils,
  PerspectiveCamera,
  Quaternion,
  Scene,
  Spherical,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Floor } from "./floor";
import { Body, type BodyColors, type BodyOptions, type BodySource } from "./body";
import { COARSE, FINE } from "./skin/mesh";
import { HOME, type Camera } from "./view";

export interface StageColors {
  readonly floor: string;
  readonly grid: string;
  readonly bodies: readonly BodyColors[];
}

export interface Shown extends BodyOptions {
  /** Seconds of each body. */
  readonly times: readonly number[];
  /** Of each body the colors of its joints, 0xrrggbb; without, those of its sides. */
  readonly tints?: readonly (readonly number[] | null)[];
  readonly follow: boolean;
  /** The first person's own view. */
  readonly eyes: boolean;
}

/** A point of a body, in pixels of the canvas. */
export interface Place {
  readonly name: string;
  readonly x: number;
  readonly y: number;
}

export interface StageEvents {
  /** The reader has moved the camera. */
  readonly onmove: (camera: Camera) => void;
  /** A picture was drawn. */
  readonly ondraw: () => void;
}

/** Software draws each pixel by itself: more of them than this cost frames. */
const MAX_PIXEL_RATIO = 1.5;
const HIP_HEIGHT = 0.9;
/** What the camera turns around at first. */
const START = new Vector3(0, HIP_HEIGHT, 0);
const FIELD_DEGREES = 40;
/** The field of the first person's view: eyes see more than a camera that shows a body. */
const EYES_DEGREES = 85;
/** How far below straight ahead they look: hands are seen then. */
const DOWN_DEGREES = 18;
/** Where a point behind the camera is said to be: outside of every canvas. */
const UNSEEN = -1e4;
/** From the turn of a head, which looks along z, to that of a camera, which looks along -z. */
const LOOK = new Quaternion().setFromEuler(
  new Euler(-MathUtils.degToRad(DOWN_DEGREES), Math.PI, 0, "YXZ"),
);
/** Meters between bodies side by side, and beside the outer ones. */
const APART = 1.4;
const ROOM = 1.5;
/** More bodies than this have coarser skins: each is smaller, and software draws them in time. */
const MAX_FINE = 2;
/** Meters over a head. */
const OVER_HEAD = 0.22;

export class Stage {
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #camera = new PerspectiveCamera(FIELD_DEGREES, 1, 0.05, 100);
  readonly #eyes = new PerspectiveCamera(EYES_DEGREES, 1, 0.02, 100);
  readonly #controls: OrbitControls;
  readonly #told: StageEvents;
  readonly #floor = new Floor();
  #bodies: readonly Body[] = [];
  #colors: StageColors;
  #apart = APART;
  #request = 0;
  #isFirstPerson = false;
  /** What the camera turns around, but for a shift. */
  readonly #base = START.clone();
  /** Whether it followed the bodies before; null at first. */
  #isFollowing: boolean | null = null;

  /** Throws without WebGL. */
  constructor(canvas: HTMLCanvasElement, colors: StageColors, told: StageEvents) {
    this.#renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: "low-power" });
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, MAX_PIXEL_RATIO));
    this.#told = told;
    this.#colors = colors;
    const sun = new DirectionalLight(0xffffff, 1.6);
    sun.position.set(2, 5, 3);
    this.#scene.add(new HemisphereLight(0xffffff, 0xb8b2a6, 2), sun, this.#floor.lines);
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.target.copy(START);
    this.#controls.minDistance = 0.5;
    this.#controls.maxDistance = 40;
    this.#controls.addEventListener("change", () => this.draw());
    this.#controls.addEventListener("end", () => this.#told.onmove(this.camera));
    this.color(colors);
  }

  get camera(): Camera {
    const { theta, phi, radius } = new Spherical().setFromVector3(
      this.#camera.position.clone().sub(this.#controls.target),
    );
    const [azimuth, polar] = [MathUtils.radToDeg(theta), MathUtils.radToDeg(phi)];
    const [x, y, z] = this.#controls.target.clone().sub(this.#base).toArray();
    return { azimuth, polar, distance: radius, shift: [x, y, z] };
  }

  set camera({ azimuth, polar, distance, shift }: Camera) {
    const from = new Vector3().setFromSphericalCoords(
      distance,
      MathUtils.degToRad(polar),
      MathUtils.degToRad(azimuth),
    );
    this.#controls.target.copy(this.#base).add(new Vector3(...shift));
    this.#camera.position.copy(this.#controls.target).add(from);
    this.#controls.update();
    this.draw();
  }

  /** The camera at first: all bodies are seen, side by side. */
  get home(): Camera {
    const wide = 2 * Math.tan(MathUtils.degToRad(FIELD_DEGREES / 2)) * this.#camera.aspect;
    const needed = (this.#apart * (this.#bodies.length - 1) + ROOM) / wide;
    return { ...HOME, distance: Math.max(HOME.distance, needed) };
  }

  color(colors: StageColors): void {
    this.#colors = colors;
    this.#scene.background = new Color(colors.floor);
    this.#floor.color(colors.grid, colors.floor);
    this.#bodies.forEach((body, place) => body.color(this.#colorsOf(place)));
    this.draw();
  }

  /** apart: meters between the bodies. */
  setBodies(sources: readonly BodySource[], apart = APART): void {
    this.#apart = apart;
    for (const body of this.#bodies) {
      body.group.removeFromParent();
      body.dispose();
    }
    const cells = sources.length > MAX_FINE ? COARSE : FINE;
    this.#bodies = sources.map((source, place) => new Body(source, this.#colorsOf(place), cells));
    const angle = MathUtils.degToRad(HOME.azimuth);
    this.#bodies.forEach(({ group }, place) => {
      const beside = apart * (place - (this.#bodies.length - 1) / 2);
      group.position.x += beside * Math.cos(angle);
      group.position.z -= beside * Math.sin(angle);
      this.#scene.add(group);
    });
    this.#base.copy(START);
    this.#controls.target.copy(START);
    this.#isFollowing = null;
  }

  /** Whether a skeleton is known to be that of a person, which can have a skin. */
  get hasPerson(): boolean {
    return this.#bodies.some((body) => body.isPerson);
  }

  show({ times, tints, follow, eyes, ...options }: Shown): void {
    this.#bodies.forEach((body, place) => body.show(times[place] ?? 0, options, tints?.[place]));
    this.#follow(follow);
    this.#isFirstPerson = eyes && this.#look();
    this.#controls.enabled = !this.#isFirstPerson;
    this.draw();
  }

  resize(width: number, height: number): void {
    if (width === 0 || height === 0) return;
    this.#renderer.setSize(width, height, false);
    for (const camera of [this.#camera, this.#eyes]) {
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
    }
    this.draw();
  }

  /** Where the joints of the first body are seen. */
  joints(): readonly Place[] {
    const names = this.#bodies[0]?.source.rig.motion.names ?? [];
    return names.map((name, joint) => this.#seen(0, joint, 0, name));
  }

  /** Where a name over each body's head is seen. */
  heads(): readonly Place[] {
    return this.#bodies.map(({ source }, place) =>
      this.#seen(place, source.head >= 0 ? source.head : source.rig.root, OVER_HEAD, ""),
    );
  }

  #seen(body: number, joint: number, above: number, name: string): Place {
    const { clientWidth: width, clientHeight: height } = this.#renderer.domElement;
    const point = new Vector3();
    const { group, pose } = this.#bodies[body] ?? {};
    if (group && pose) group.localToWorld(point.fromArray(pose, joint * 3));
    point.setY(point.y + above).project(this.#seeing);
    if (point.z > 1) return { name, x: UNSEEN, y: UNSEEN };
    return { name, x: ((point.x + 1) / 2) * width, y: ((1 - point.y) / 2) * height };
  }

  /** Draw before the next frame, once however often it is called. */
  draw(): void {
    this.#request ||= requestAnimationFrame(() => {
      this.#request = 0;
      this.#renderer.render(this.#scene, this.#seeing);
      this.#told.ondraw();
    });
  }

  dispose(): void {
    cancelAnimationFrame(this.#request);
    this.setBodies([]);
    this.#controls.dispose();
    this.#floor.dispose();
    this.#renderer.dispose();
  }

  #colorsOf(place: number): BodyColors {
    const { bodies } = this.#colors;
    const colors = bodies[place % bodies.length];
    if (!colors) throw new Error("A stage needs colors for its bodies.");
    return colors;
  }

  get #seeing(): PerspectiveCamera {
    return this.#isFirstPerson ? this.#eyes : this.#camera;
  }

  /** Look out of the eyes of the first person; whether there is one. */
  #look(): boolean {
    const body = this.#bodies.find(({ isPerson }) => isPerson);
    const eyes = body?.eyes;
    if (!body || !eyes) return false;
    this.#eyes.position.copy(eyes.place).add(body.group.position);
    this.#eyes.quaternion.copy(eyes.turn).multiply(LOOK);
    return true;
  }

  /** Go with the middle of the bodies over the floor, or stay. */
  #follow(follows: boolean): void {
    const { target } = this.#controls;
    const stood = this.#isFollowing === false ? target.clone().setY(HIP_HEIGHT) : this.#base;
    const next = follows ? this.#middle() : START;
    if (follows) {
      const gone = next.clone().sub(stood);
      target.add(gone);
      this.#camera.position.add(gone);
      this.#controls.update();
    }
    this.#base.copy(next);
    const hasStopped = this.#isFollowing === true && !follows;
    this.#isFollowing = follows;
    if (hasStopped) this.#told.onmove(this.camera);
  }

  #middle(): Vector3 {
    const middle = new Vector3();
    const hips = new Vector3();
    for (const { pose, source, group } of this.#bodies) {
      middle.add(hips.fromArray(pose, source.rig.root * 3).add(group.position));
    }
    return middle.divideScalar(Math.max(1, this.#bodies.length)).setY(HIP_HEIGHT);
  }
}
