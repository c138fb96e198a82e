/**
 * The solids that a stand-in body is made of, to the measure of its rest: ellipsoids and tapered
 * rods with round ends. Each gives the distance of a point from its surface (below 0 inside), and
 * the parts of the body that move it.
 */
import { Vector3 } from "three";
import { SIDES, type Landmarks } from "./anatomy";
import type { Part } from "./frames";
import type { Rest } from "./rest";

export type Shares = readonly (readonly [Part, number])[];

export interface Solid {
  /** Meters; negative inside. */
  distance(x: number, y: number, z: number): number;
  shares(y: number): Shares;
  /** The corners of a box that contains it. */
  readonly low: Vector3;
  readonly high: Vector3;
}

/** All solids of a body. Sizes are shares of the stature. */
export function solidsOf({ at, stature }: Rest): readonly Solid[] {
  return [...trunk(at, stature), ...SIDES.flatMap((side) => limbs(at, stature, side))];
}

function trunk(at: Landmarks, size: number): Solid[] {
  const half = at.left_hip.x;
  const wide = at.left_shoulder.x;
  const long = at.hips.distanceTo(at.neck);
  const along = trunkShares(at);
  const belly = at.hips.clone().lerp(at.neck, 0.38);
  const chest = at.hips.clone().lerp(at.neck, 0.68);
  const oval = (middle: Vector3, x: number, y: number, z: number, shares = along): Solid =>
    ellipsoid(middle, new Vector3(x, y, z), shares);
  const off = (from: Vector3, y: number, z: number): Vector3 =>
    from.clone().add(new Vector3(0, y * size, z * size));
  const skull = skullOf(at, size);
  const head = fixed("head");
  return [
    oval(off(at.hips, 0.004, -0.006), half * 0.55 + 0.056 * size, 0.075 * size, 0.062 * size),
    oval(off(belly, 0, 0.004), 0.074 * size, 0.34 * long, 0.053 * size),
    oval(off(chest, 0, 0), 0.35 * wide + 0.062 * size, 0.35 * long, 0.062 * size),
    ...SIDES.map((side) => {
      const breast = chest.clone().lerp(at[`${side}_shoulder`], 0.42);
      return oval(off(breast, -0.012, 0.03), 0.044 * size, 0.04 * size, 0.03 * size);
    }),
    ...SIDES.map((side) => {
      const blade = chest.clone().lerp(at[`${side}_shoulder`], 0.5);
      return oval(off(blade, -0.01, -0.032), 0.04 * size, 0.05 * size, 0.028 * size);
    }),
    rod(off(at.neck, -0.012, -0.01), off(skull, -0.02, -0.012), 0.034 * size, 0.031 * size, () => [
      ["chest", 0.2],
      ["neck", 0.5],
      ["head", 0.3],
    ]),
    oval(off(skull, 0.008, -0.005), 0.0435 * size, 0.056 * size, 0.055 * size, head),
    oval(off(skull, -0.028, 0.016), 0.03 * size, 0.036 * size, 0.034 * size, head),
    oval(off(skull, -0.014, 0.052), 0.009 * size, 0.015 * size, 0.012 * size, head),
  ];
}

/** The middle of the skull: files have the joint of the head at its base, middle or top. */
export function skullOf({ neck, head }: Landmarks, size: number): Vector3 {
  const up = new Vector3().subVectors(head, neck);
  const lean = up.length() > 0 ? Math.min(0.35, Math.abs(up.z) / up.length()) * Math.sign(up.z) : 0;
  return neck.clone().add(new Vector3(0, 0.102 * size, lean * 0.102 * size));
}

function limbs(at: Landmarks, size: number, side: "left" | "right"): Solid[] {
  return [...arm(at, size, side), ...leg(at, size, side)];
}

function arm(at: Landmarks, size: number, side: "left" | "right"): Solid[] {
  const [shoulder, elbow] = [at[`${side}_shoulder`], at[`${side}_elbow`]];
  const [hand, fingers] = [at[`${side}_hand`], at[`${side}_fingers`]];
  const tapered = (from: Vector3, to: Vector3, start: number, end: number, part: Part): Solid =>
    rod(from, to, start * size, end * size, fixed(part));
  const down = new Vector3().subVectors(hand, elbow);
  const belly = elbow.clone().addScaledVector(down, 0.28);
  const along = new Vector3().subVectors(fingers, hand).normalize();
  const palm = hand.clone().addScaledVector(along, 0.046 * size);
  const thumb = hand.clone().addScaledVector(along, 0.018 * size);
  const tip = thumb
    .clone()
    .addScaledVector(along, 0.03 * size)
    .add(new Vector3(0, 0, 0.026 * size));
  const nape = at.neck.clone().add(new Vector3(0, 0.018 * size, -0.016 * size));
  const collar = at.neck
    .clone()
    .lerp(shoulder, 0.15)
    .add(new Vector3(0, -0.004 * size, -0.008 * size));
  return [
    rod(collar, shoulder, 0.034 * size, 0.03 * size, fixed("chest")),
    rod(nape, shoulder.clone().lerp(nape, 0.12), 0.026 * size, 0.027 * size, fixed("chest")),
    tapered(shoulder, shoulder.clone().lerp(elbow, 0.12), 0.036, 0.034, `${side}_deltoid`),
    tapered(shoulder.clone().lerp(elbow, 0.15), elbow, 0.031, 0.023, `${side}_upper_arm`),
    ellipsoid(
      shoulder
        .clone()
        .lerp(elbow, 0.5)
        .add(new Vector3(0, 0, 0.004 * size)),
      new Vector3(0.029, 0.068, 0.032).multiplyScalar(size),
      fixed(`${side}_upper_arm`),
      along,
    ),
    tapered(elbow, elbow, 0.0225, 0.0225, `${side}_elbow`),
    tapered(elbow, belly, 0.0225, 0.0255, `${side}_forearm`),
    tapered(belly, hand, 0.0255, 0.0155, `${side}_forearm`),
    ellipsoid(
      palm,
      new Vector3(0.0135, 0.056, 0.026).multiplyScalar(size),
      fixed(`${side}_hand`),
      along,
    ),
    tapered(thumb, tip, 0.011, 0.008, `${side}_hand`),
  ];
}

function leg(at: Landmarks, size: number, side: "left" | "right"): Solid[] {
  const [hip, knee] = [at[`${side}_hip`], at[`${side}_knee`]];
  const [foot, toes] = [at[`${side}_foot`], at[`${side}_toes`]];
  const tapered = (from: Vector3, to: Vector3, start: number, end: number, part: Part): Solid =>
    rod(from, to, start * size, end * size, fixed(part));
  const off = (from: Vector3, x: number, y: number, z: number): Vector3 =>
    from.clone().add(new Vector3(x, y, z).multiplyScalar(size));
  const out = Math.sign(hip.x) || 1;
  const calf = off(knee.clone().lerp(foot, 0.28), 0, 0, -0.009);
  const heel = off(foot, 0, -0.018, -0.016);
  const ball = off(toes, 0, 0.003, 0);
  return [
    tapered(
      off(hip, 0, -0.012, -0.026),
      off(hip, 0, -0.02, -0.024),
      0.048,
      0.048,
      `${side}_buttock`,
    ),
    tapered(off(hip, 0, -0.02, 0), off(hip, 0, -0.035, 0), 0.052, 0.052, `${side}_buttock`),
    tapered(off(hip, out * 0.004, -0.04, 0), knee, 0.053, 0.031, `${side}_thigh`),
    tapered(off(hip.clone().lerp(knee, 0.45), 0, 0, 0.009), knee, 0.039, 0.027, `${side}_thigh`),
    tapered(knee, knee, 0.031, 0.031, `${side}_knee`),
    tapered(off(knee, 0, -0.01, 0), calf, 0.029, 0.0335, `${side}_shin`),
    tapered(calf, foot, 0.0335, 0.0205, `${side}_shin`),
    tapered(heel, heel, 0.021, 0.021, `${side}_foot`),
    ...[-1, 1].map((x) =>
      tapered(
        off(heel, x * 0.004, 0.001, 0),
        off(ball, x * 0.013, 0, 0),
        0.02,
        0.013,
        `${side}_foot`,
      ),
    ),
    tapered(
      off(foot, 0, 0, 0.004),
      off(ball, -out * 0.006, 0, -0.01),
      0.021,
      0.014,
      `${side}_foot`,
    ),
    ...[-1, 0.4].map((x) =>
      tapered(
        off(ball, x * out * 0.012, -0.001, 0),
        off(ball, x * out * 0.012, -0.002, 0.035),
        0.0125,
        0.01,
        `${side}_foot`,
      ),
    ),
  ];
}

function fixed(part: Part): (y: number) => Shares {
  return () => [[part, 1]];
}

/** The trunk bends along its whole height: from the pelvis over the waist to the chest. */
function trunkShares({ hips, waist, neck }: Landmarks): (y: number) => Shares {
  const low = waist.y - hips.y || 1;
  const high = neck.y - waist.y || 1;
  return (y) => {
    if (y < waist.y) {
      const share = eased((y - hips.y) / low);
      return [
        ["pelvis", 1 - share],
        ["waist", share],
      ];
    }
    const share = eased((y - waist.y) / (0.6 * high));
    return [
      ["waist", 1 - share],
      ["chest", share],
    ];
  };
}

function eased(share: number): number {
  const within = Math.min(1, Math.max(0, share));
  return within * within * (3 - 2 * within);
}

/** A rod from `from` to `to` whose radius goes from `start` to `end`. */
export function rod(
  from: Vector3,
  to: Vector3,
  start: number,
  end: number,
  shares: (y: number) => Shares,
): Solid {
  const along = new Vector3().subVectors(to, from);
  const squared = along.lengthSq();
  const most = Math.max(start, end);
  return {
    shares,
    low: from.clone().min(to).subScalar(most),
    high: from.clone().max(to).addScalar(most),
    distance: (x, y, z) => {
      let dx = x - from.x;
      let dy = y - from.y;
      let dz = z - from.z;
      const dot = dx * along.x + dy * along.y + dz * along.z;
      const share = squared > 0 ? Math.min(1, Math.max(0, dot / squared)) : 0;
      dx -= share * along.x;
      dy -= share * along.y;
      dz -= share * along.z;
      return Math.sqrt(dx * dx + dy * dy + dz * dz) - (start + share * (end - start));
    },
  };
}

/** An ellipsoid; `axis`: a unit vector in the plane of x and y that its y goes along. The distance
    is nearly right near the surface (Quilez, "Ellipsoid SDF"). */
export function ellipsoid(
  middle: Vector3,
  radii: Vector3,
  shares: (y: number) => Shares,
  axis = new Vector3(0, 1, 0),
): Solid {
  const most = Math.max(radii.x, radii.y, radii.z);
  const [ax, ay] = [1 / radii.x, 1 / radii.y];
  const az = 1 / radii.z;
  return {
    shares,
    low: middle.clone().subScalar(most),
    high: middle.clone().addScalar(most),
    distance: (x, y, z) => {
      const [dx, dy] = [x - middle.x, y - middle.y];
      const across = (axis.y * dx - axis.x * dy) * ax;
      const along = (axis.x * dx + axis.y * dy) * ay;
      const deep = (z - middle.z) * az;
      const far = Math.sqrt(across * across + along * along + deep * deep);
      const steep = Math.sqrt((across * ax) ** 2 + (along * ay) ** 2 + (deep * az) ** 2);
      return steep > 0 ? (far * (far - 1)) / steep : -Math.min(radii.x, radii.y, radii.z);
    },
  };
}
