/** Motion of clips as numbers, ready to draw. */
import { askFor, type Schemas } from "$/api/client";
import { Kept } from "$/core/kept";
import { ROLES } from "./roles";

export interface Motion {
  readonly frameRate: number;
  readonly frames: number;
  readonly joints: number;
  /** (frames, joints, 3) meters, Y up, one after the other. */
  readonly positions: Float32Array;
}

export interface SkeletonMotion extends Motion {
  readonly names: readonly string[];
  /** Index of each joint's parent; -1 for a root. */
  readonly parents: readonly number[];
}

type MotionAnswer = Pick<Schemas["Motion"], "frame_rate" | "joint_names" | "parents" | "positions">;

const OCTETS = { Accept: "application/octet-stream" };
const PREVIEW_RATE = 30;
const MAX_KEPT = 64;
const kept = new Kept<string, Promise<Motion>>(MAX_KEPT);

/** The 13 joints of a clip, in the order of ROLES. Throws ApiProblem, Away. */
export function roleMotion(clipId: string): Promise<Motion> {
  const found = kept.get(clipId);
  if (found) return found;
  const asked = octets(`${pathOf(clipId)}?joints=roles&fps=${PREVIEW_RATE}`, ROLES.length);
  kept.set(clipId, asked);
  asked.catch(() => kept.delete(clipId));
  return asked;
}

/**
 * All joints of a clip at a frame rate. Names and parents come with the JSON form only, of which
 * a frame a second is asked for; the positions come as octets, a third of the size.
 */
export async function skeletonMotion(
  clipId: string,
  frameRate: number,
  signal: AbortSignal,
): Promise<SkeletonMotion> {
  const path = pathOf(clipId);
  const [described, motion] = await Promise.all([
    askFor(`${path}?fps=1`, { signal }).then((answer) => answer.json() as Promise<MotionAnswer>),
    octets(`${path}?fps=${frameRate}`, 0, signal),
  ]);
  return { ...motion, names: described.joint_names, parents: described.parents };
}

/** A motion of a pair of the study, from the path that the pair gives. */
export async function pairMotion(path: string, signal: AbortSignal): Promise<SkeletonMotion> {
  return fromAnswer((await (await askFor(path, { signal })).json()) as MotionAnswer);
}

/** A motion in the form of JSON as one to play. */
export function fromAnswer(answer: MotionAnswer): SkeletonMotion {
  return {
    names: answer.joint_names,
    parents: answer.parents,
    frameRate: answer.frame_rate,
    frames: answer.positions.length,
    joints: answer.joint_names.length,
    positions: new Float32Array(answer.positions.flat(2)),
  };
}

const pathOf = (clipId: string): string => `/v1/clips/${encodeURIComponent(clipId)}/motion`;

async function octets(path: string, joints: number, signal?: AbortSignal): Promise<Motion> {
  const answer = await askFor(path, { headers: OCTETS, ...(signal && { signal }) });
  const shape = (answer.headers.get("X-Shape") ?? "").split(",").map(Number);
  const frameRate = Number(answer.headers.get("X-Frame-Rate"));
  const positions = new Float32Array(await answer.arrayBuffer());
  return { frameRate, frames: shape[0] ?? 0, joints: shape[1] ?? joints, positions };
}
