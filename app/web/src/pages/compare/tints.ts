/** The colors of joints by how far two bodies are apart. */
import { rgb, type Rgb } from "$/core/color";
import { tokenColor } from "$/core/token";
import type { SkeletonMotion } from "$/motion/motion";
import { rolesOfJoints } from "./bodies";
import type { Path } from "./path";
import { colorOf, hex } from "./scale";

const RAMP = ["--ramp-1", "--ramp-2", "--ramp-3"];

export interface Colors {
  readonly ramp: readonly Rgb[];
  /** 0xrrggbb, of joints that have no difference or are not marked. */
  readonly unmarked: number;
  /** 0xrrggbb, of the body below another. */
  readonly below: number;
}

/** The colors of the theme where an element stands. */
export function colorsAt(element: Element): Colors {
  const token = (name: string): Rgb => rgb(tokenColor(element, name));
  return {
    ramp: RAMP.map(token),
    unmarked: hex(token("--trunk")),
    below: hex(token("--line-strong")),
  };
}

export interface TintOptions {
  readonly colors: Colors;
  /** Meters that get the last color. */
  readonly top: number;
  /** The joint that is marked; "": all. */
  readonly joint: string;
}

export class Tints {
  /** The place of the role of each joint in the alignment. */
  readonly #places = new WeakMap<SkeletonMotion, readonly number[]>();

  /** (joints,) 0xrrggbb at a common time of the path. roles: names of joints by role. */
  at(
    path: Path,
    seconds: number,
    motion: SkeletonMotion,
    roles: Readonly<Record<string, string>>,
    { colors, top, joint }: TintOptions,
  ): readonly number[] {
    const differences = path.differencesAt(seconds);
    const { joints } = path.alignment;
    return this.#placesOf(motion, roles, joints).map((place) =>
      place < 0 || (joint && joints[place] !== joint)
        ? colors.unmarked
        : colorOf(differences[place] ?? 0, top, colors.ramp),
    );
  }

  #placesOf(
    motion: SkeletonMotion,
    roles: Readonly<Record<string, string>>,
    joints: readonly string[],
  ): readonly number[] {
    const found = this.#places.get(motion) ?? rolesOfJoints(motion, roles, joints);
    this.#places.set(motion, found);
    return found;
  }
}
