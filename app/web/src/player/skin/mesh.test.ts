import { Box3, Matrix4, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import type { SkeletonMotion } from "$/motion/motion";
import { anatomyOf, emptyLandmarks, landmarksOf, type Anatomy } from "./anatomy";
import { Eyes } from "./eyes";
import { Frames, PARTS } from "./frames";
import { COARSE, MAX_PARTS, meshOf, sharesOf, type BodyMesh } from "./mesh";
import { skinned } from "./skinned";

/** A person of 1.75 m who stands and faces z, arms down; meters. */
const JOINTS: Readonly<Record<string, readonly [string | null, number, number, number]>> = {
  hips: [null, 0, 0.95, 0],
  chest: ["hips", 0, 1.2, 0],
  neck: ["chest", 0, 1.45, 0],
  head: ["neck", 0, 1.58, 0.02],
  ...sided("left", 1),
  ...sided("right", -1),
};

function sided(side: string, sign: number) {
  return {
    [`${side}_shoulder`]: ["neck", sign * 0.19, 1.42, 0],
    [`${side}_elbow`]: [`${side}_shoulder`, sign * 0.22, 1.12, 0],
    [`${side}_hand`]: [`${side}_elbow`, sign * 0.23, 0.86, 0.03],
    [`${side}_upper_leg`]: ["hips", sign * 0.1, 0.93, 0],
    [`${side}_knee`]: [`${side}_upper_leg`, sign * 0.1, 0.5, 0],
    [`${side}_foot`]: [`${side}_knee`, sign * 0.1, 0.07, 0],
    [`${side}_toes`]: [`${side}_foot`, sign * 0.1, 0.02, 0.16],
  } as const satisfies Record<string, readonly [string, number, number, number]>;
}

const NAMES = Object.keys(JOINTS);
const ROLES = Object.fromEntries(NAMES.map((name) => [name, name]));
const STANDING: Float32Array = new Float32Array(
  Object.values(JOINTS).flatMap(([, ...place]) => place),
);

function motionOf(positions: Float32Array): SkeletonMotion {
  return {
    names: NAMES,
    parents: Object.values(JOINTS).map(([above]) => (above ? NAMES.indexOf(above) : -1)),
    frameRate: 30,
    frames: 1,
    joints: NAMES.length,
    positions,
  };
}

/** The standing person with its points moved. */
function moved(move: (point: Vector3, name: string) => Vector3): Float32Array {
  const out = STANDING.slice();
  NAMES.forEach((name, joint) => {
    move(new Vector3().fromArray(out, joint * 3), name).toArray(out, joint * 3);
  });
  return out;
}

function known(positions = STANDING, roles = ROLES): Anatomy {
  const anatomy = anatomyOf(motionOf(positions), roles);
  if (!anatomy) throw new Error("expected a person");
  return anatomy;
}

/** The matrices of the parts of a body of a size in a pose, and its mesh. */
function bodyIn(size: Float32Array, pose: Float32Array): [BodyMesh, Matrix4[]] {
  const anatomy = known(size);
  const mesh = meshOf(motionOf(size), anatomy, COARSE);
  const matrices = PARTS.map(() => new Matrix4());
  new Frames(mesh.rest.at).show(landmarksOf(anatomy, pose, emptyLandmarks()), matrices);
  return [mesh, matrices];
}

function vectors(values: Float32Array): Vector3[] {
  return Array.from({ length: values.length / 3 }, (_, at) =>
    new Vector3().fromArray(values, at * 3),
  );
}

/** Each point of a mesh in a pose. */
function posed(size: Float32Array, pose: Float32Array): Vector3[] {
  const [mesh, matrices] = bodyIn(size, pose);
  const [points, normals] = [mesh.points.slice(), mesh.points.slice()];
  skinned(mesh, matrices, points, normals);
  return vectors(points);
}

const RAISED = moved((point, name) =>
  /^left_(elbow|hand)$/.test(name) ? point.set(point.x, 2.84 - point.y, point.z) : point,
);

describe("the skin of a body", () => {
  const mesh = meshOf(motionOf(STANDING), known());
  const points = vectors(mesh.points);

  it("has finite points, and weights that sum to one", () => {
    expect(points.length).toBeGreaterThan(3000);
    expect([...mesh.points, ...mesh.normals].every(Number.isFinite)).toBe(true);
    for (let at = 0; at < mesh.weights.length; at += MAX_PARTS) {
      const weights = [...mesh.weights.slice(at, at + MAX_PARTS)];
      expect(weights.reduce((sum, weight) => sum + weight, 0)).toBeCloseTo(1, 5);
      expect(weights).toEqual([...weights].sort((a, b) => b - a));
    }
  });

  it("is moved as by a slow twin: the sum of the points that each part moves", () => {
    const [made, matrices] = bodyIn(STANDING, RAISED);
    const [fast, normals] = [made.points.slice(), made.points.slice()];
    skinned(made, matrices, fast, normals);
    vectors(made.points).forEach((point, vertex) => {
      const sum = new Vector3();
      for (let at = vertex * MAX_PARTS; at < (vertex + 1) * MAX_PARTS; at += 1) {
        const matrix = matrices[made.indices[at] ?? 0] ?? new Matrix4();
        sum.addScaledVector(point.clone().applyMatrix4(matrix), made.weights[at] ?? 0);
      }
      expect(sum.distanceTo(new Vector3().fromArray(fast, vertex * 3))).toBeLessThan(1e-5);
    });
    expect([...normals].every(Number.isFinite)).toBe(true);
  });

  it("is closed, and seen from outside: each edge goes as often forth as back", () => {
    const edges = new Map<string, number>();
    const corners = [...mesh.triangles];
    for (let at = 0; at < corners.length; at += 3) {
      for (const [a, b] of [
        [0, 1],
        [1, 2],
        [2, 0],
      ] as const) {
        const [from = 0, to = 0] = [corners[at + a], corners[at + b]];
        const edge = `${Math.min(from, to)} ${Math.max(from, to)}`;
        edges.set(edge, (edges.get(edge) ?? 0) + Math.sign(to - from));
      }
    }
    expect([...edges.values()].every((sum) => sum === 0)).toBe(true);
    let volume = 0;
    const corner = (at: number): Vector3 => (points[corners[at] ?? 0] ?? new Vector3()).clone();
    for (let at = 0; at < corners.length; at += 3) {
      volume += corner(at).dot(corner(at + 1).cross(corner(at + 2))) / 6;
    }
    // A person of 1.75 m has about 0.07 cubic meters.
    expect(volume).toBeGreaterThan(0.04);
    expect(volume).toBeLessThan(0.1);
  });

  it.each([0.5, 1, 1.15])("is as tall as the skeleton, times %f", (times) => {
    const size = STANDING.map((value) => value * times);
    const box = new Box3().setFromPoints(posed(size, size));
    expect(box.min.y / times).toBeCloseTo(0, 1);
    expect(box.max.y / times).toBeGreaterThan(1.62);
    expect(box.max.y / times).toBeLessThan(1.82);
  });

  it("goes where the person goes: turned and shifted, it has the same form", () => {
    const turn = new Matrix4().makeRotationY(2).setPosition(3, 0, -1);
    const there = posed(
      STANDING,
      moved((point) => point.applyMatrix4(turn)),
    );
    posed(STANDING, STANDING).forEach((point, vertex) => {
      expect(point.applyMatrix4(turn).distanceTo(there[vertex] ?? point)).toBeLessThan(1e-5);
    });
  });

  it("a hand over the head takes the arm's skin along, and nothing else", () => {
    const [before, after] = [posed(STANDING, STANDING), posed(STANDING, RAISED)];
    const highest = Math.max(...after.map(({ y }) => y));
    expect(highest).toBeGreaterThan(2);
    const legs = before.flatMap((point, vertex) =>
      point.y < 0.8 && Math.abs(point.x) < 0.15 ? [vertex] : [],
    );
    for (const vertex of legs) {
      expect(after[vertex]?.distanceTo(before[vertex] ?? new Vector3(9))).toBeLessThan(1e-6);
    }
  });

  it("has its left on the left", () => {
    const left = sharesOf(mesh, "left");
    const sides = [...left].map((share, vertex) => share * (points[vertex]?.x ?? 0));
    expect(Math.min(...sides)).toBeGreaterThan(-0.01);
    const whole = sharesOf(mesh, "right").map((share, vertex) => share + (left[vertex] ?? 0));
    expect(Math.max(...whole)).toBeLessThanOrEqual(1.000001);
  });

  it("is bones where roles are missing, or the limbs are not those of a person", () => {
    const { left_knee, ...others } = ROLES;
    expect(left_knee).toBe("left_knee");
    expect(anatomyOf(motionOf(STANDING), others)).toBeNull();
    const short = moved((point, name) => (/knee|foot|toes/.test(name) ? point.setY(0.85) : point));
    expect(anatomyOf(motionOf(short), ROLES)).toBeNull();
  });

  it("needs neither toes nor fingers nor a spine", () => {
    const needed = Object.fromEntries(
      NAMES.filter((name) => !/toes|chest|upper_leg/.test(name)).map((name) => [name, name]),
    );
    const { points: all } = meshOf(motionOf(STANDING), known(STANDING, needed), COARSE);
    expect([...all].every(Number.isFinite)).toBe(true);
  });
});

describe("the eyes", () => {
  const anatomy = known();
  const eyes = new Eyes(anatomy, meshOf(motionOf(STANDING), anatomy).rest);

  it("are before the head, and look ahead", () => {
    const { place, turn } = eyes.in(STANDING);
    expect(place.y).toBeGreaterThan(1.5);
    expect(place.y).toBeLessThan(1.7);
    expect(place.z).toBeGreaterThan(0.08);
    expect(new Vector3(0, 0, 1).applyQuaternion(turn).z).toBeCloseTo(1, 3);
  });

  it("turn with the person", () => {
    const back = moved(({ x, y, z }) => new Vector3(-x, y, -z));
    const { place, turn } = eyes.in(back);
    expect(place.z).toBeLessThan(-0.08);
    expect(new Vector3(0, 0, 1).applyQuaternion(turn).z).toBeCloseTo(-1, 3);
  });
});
