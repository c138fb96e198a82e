/**
 * The parts of a body in space: where each part is, and how it is turned, from the landmarks alone.
 *
 * At rest (see `build.ts`) no part is turned. In a pose the pelvis and the chest are turned with
 * their own landmarks, and each part of a limb by the smallest turn from the part before it: so a
 * limb is never twisted more than its joints show. Between two parts stands a half-turned one, which
 * keeps the skin of a bent joint full.
 */
import { Matrix4, Quaternion, Vector3 } from "three";
import { SIDES, type Landmark, type Landmarks } from "./anatomy";

const TRUNK_PARTS = ["pelvis", "waist", "chest", "neck", "head"] as const;
const LIMB_PARTS = [
  ...(["deltoid", "upper_arm", "elbow", "forearm", "hand"] as const),
  ...(["buttock", "thigh", "knee", "shin", "foot"] as const),
] as const;
export type Part =
  (typeof TRUNK_PARTS)[number] | `${"left" | "right"}_${(typeof LIMB_PARTS)[number]}`;
export const PARTS: readonly Part[] = [
  ...TRUNK_PARTS,
  ...SIDES.flatMap((side) => LIMB_PARTS.map((part): Part => `${side}_${part}`)),
];

/** A part along a limb: from a landmark to the next, turned from the part before it. */
interface Link {
  readonly part: Part;
  readonly before: Part;
  /** The half-turned part between both, at the same landmark. */
  readonly between?: Part;
  readonly from: Landmark;
  readonly to: Landmark;
}

const LINKS: readonly Link[] = [
  { part: "head", before: "chest", between: "neck", from: "neck", to: "head" },
  ...SIDES.flatMap((side): readonly Link[] => [
    {
      part: `${side}_upper_arm`,
      before: "chest",
      between: `${side}_deltoid`,
      from: `${side}_shoulder`,
      to: `${side}_elbow`,
    },
    {
      part: `${side}_forearm`,
      before: `${side}_upper_arm`,
      between: `${side}_elbow`,
      from: `${side}_elbow`,
      to: `${side}_hand`,
    },
    {
      part: `${side}_hand`,
      before: `${side}_forearm`,
      from: `${side}_hand`,
      to: `${side}_fingers`,
    },
    {
      part: `${side}_thigh`,
      before: "pelvis",
      between: `${side}_buttock`,
      from: `${side}_hip`,
      to: `${side}_knee`,
    },
    {
      part: `${side}_shin`,
      before: `${side}_thigh`,
      between: `${side}_knee`,
      from: `${side}_knee`,
      to: `${side}_foot`,
    },
    { part: `${side}_foot`, before: `${side}_shin`, from: `${side}_foot`, to: `${side}_toes` },
  ]),
];
/** Parts that keep their length: hands and feet of files end where they like. */
const FIXED = /hand|foot|head/;

export interface Frame {
  readonly place: Vector3;
  readonly turn: Quaternion;
}

/** A turn whose x goes from right to left and whose y is nearly `up`; no turn without a width. */
export function basis(left: Vector3, right: Vector3, up: Vector3): Quaternion {
  const x = new Vector3().subVectors(left, right).normalize();
  const z = new Vector3().crossVectors(x, up).normalize();
  if (x.lengthSq() === 0 || z.lengthSq() === 0) return new Quaternion();
  const y = new Vector3().crossVectors(z, x);
  return new Quaternion().setFromRotationMatrix(new Matrix4().makeBasis(x, y, z));
}

export function pelvisTurn({ left_hip, right_hip, waist, hips }: Landmarks): Quaternion {
  return basis(left_hip, right_hip, new Vector3().subVectors(waist, hips));
}

export function chestTurn({ left_shoulder, right_shoulder, neck, waist }: Landmarks): Quaternion {
  return basis(left_shoulder, right_shoulder, new Vector3().subVectors(neck, waist));
}

/** The frames of all parts in a pose, in the order of PARTS, written as matrices that move the skin
    from rest to the pose. */
export class Frames {
  readonly #frames = Object.fromEntries(
    PARTS.map((part) => [part, { place: new Vector3(), turn: new Quaternion() }]),
  ) as Record<Part, Frame>;

  constructor(private readonly rest: Landmarks) {}

  /** Place and turn of a part in the pose that was shown last. */
  of(part: Part): Frame {
    return this.#frames[part];
  }

  show(pose: Landmarks, out: readonly Matrix4[]): void {
    const { pelvis, waist, chest } = this.#frames;
    pelvis.turn.copy(pelvisTurn(pose));
    chest.turn.copy(chestTurn(pose));
    waist.turn.slerpQuaternions(pelvis.turn, chest.turn, 0.5);
    this.#write(out, "pelvis", "hips", "hips", "waist", pose);
    this.#write(out, "waist", "waist", "hips", "neck", pose);
    this.#write(out, "chest", "neck", "waist", "neck", pose);
    for (const link of LINKS) this.#link(link, pose, out);
  }

  #link({ part, before, between, from, to }: Link, pose: Landmarks, out: readonly Matrix4[]): void {
    const above = this.#frames[before].turn;
    const turn = this.#frames[part].turn.copy(above);
    const rest = new Vector3().subVectors(this.rest[to], this.rest[from]).normalize();
    const now = new Vector3().subVectors(pose[to], pose[from]).normalize();
    if (now.lengthSq() > 0 && rest.lengthSq() > 0) {
      turn.premultiply(new Quaternion().setFromUnitVectors(rest.applyQuaternion(above), now));
    }
    this.#write(out, part, from, from, to, pose);
    if (!between) return;
    this.#frames[between].turn.slerpQuaternions(above, turn, 0.5);
    this.#write(out, between, from, from, from, pose);
  }

  /** The matrix of a part that stands at a landmark, as long as it is from `start` to `end`. */
  #write(
    out: readonly Matrix4[],
    part: Part,
    at: Landmark,
    start: Landmark,
    end: Landmark,
    pose: Landmarks,
  ): void {
    const { place, turn } = this.#frames[part];
    place.copy(pose[at]);
    const along = new Vector3().subVectors(this.rest[end], this.rest[start]);
    const length = along.length();
    const reach = pose[end].distanceTo(pose[start]);
    const stretch = length > 0 && reach > 0 && !FIXED.test(part) ? reach / length : 1;
    out[PARTS.indexOf(part)]
      ?.makeRotationFromQuaternion(turn)
      .multiply(stretched(along.normalize(), stretch))
      .setPosition(place)
      .multiply(new Matrix4().makeTranslation(this.rest[at].clone().negate()));
  }
}

/** Makes `times` as long along a unit vector: I + (times - 1) d dT. */
function stretched({ x, y, z }: Vector3, times: number): Matrix4 {
  const more = times - 1;
  const row = (a: number): [number, number, number] => [more * a * x, more * a * y, more * a * z];
  const [[xx, xy, xz], [, yy, yz], [, , zz]] = [row(x), row(y), row(z)];
  // prettier-ignore
  return new Matrix4().set(
    1 + xx, xy, xz, 0,
    xy, 1 + yy, yz, 0,
    xz, yz, 1 + zz, 0,
    0, 0, 0, 1,
  );
}
