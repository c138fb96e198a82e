/** What a person sees: the place of the eyes and the turn of the head in a pose. */
import { Matrix4, Vector3 } from "three";
import { emptyLandmarks, landmarksOf, type Anatomy } from "./anatomy";
import { Frames, PARTS, type Frame } from "./frames";
import type { Rest } from "./rest";
import { skullOf } from "./solids";

/** Shares of the stature: the eyes before the middle of the skull, where no face hides the view. */
const BEFORE = 0.066;

export class Eyes {
  readonly #frames: Frames;
  readonly #landmarks = emptyLandmarks();
  readonly #matrices = PARTS.map(() => new Matrix4());
  /** Where the eyes are at rest. */
  readonly #place: Vector3;

  constructor(
    private readonly anatomy: Anatomy,
    { at, stature }: Rest,
  ) {
    this.#frames = new Frames(at);
    this.#place = skullOf(at, stature).add(new Vector3(0, 0, BEFORE * stature));
  }

  /** In a pose, (joints, 3) meters: the place of the eyes; the view goes along z of the turn. */
  in(pose: Float32Array): Frame {
    this.#frames.show(landmarksOf(this.anatomy, pose, this.#landmarks), this.#matrices);
    const place = this.#place.clone();
    const head = this.#matrices[PARTS.indexOf("head")];
    return { place: head ? place.applyMatrix4(head) : place, turn: this.#frames.of("head").turn };
  }
}
