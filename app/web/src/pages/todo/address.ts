/** The queue's state in its address, and the clips that are in it. */
import type { ClipQuery } from "$/pages/gallery/address";
import { choice, text, type Values } from "$/core/query";
import { PLAYER } from "$/player/view";

export const KINDS = {
  doubts: "Doubts",
  failed: "Failed",
  unlabeled: "Without labels",
} as const;
export type Kind = keyof typeof KINDS;

export const LACKS = { task: "a task", person: "a person", words: "words" } as const;
export type Lack = keyof typeof LACKS;

export const TODO = {
  ...PLAYER,
  /** any: the first kind that has clips. */
  kind: choice(["any", ...(Object.keys(KINDS) as Kind[])], "any"),
  lacks: choice(Object.keys(LACKS) as Lack[], "task"),
  /** Id of the clip that is looked at; the first one where there is none. */
  at: text(),
};
export type TodoValues = Values<typeof TODO>;

/** The clips of a kind, as the API takes it. */
export function queueQuery(kind: Kind, lacks: Lack): ClipQuery {
  if (kind === "failed") return { state: "failed", sort: "created_at" };
  if (kind === "doubts") return { state: "ready", has_warnings: true, sort: "created_at" };
  return { state: "ready", missing: [lacks], sort: "created_at" };
}

/** The id that stands `by` places from another; the nearest there is at the ends. */
export function stepped(ids: readonly string[], at: string, by: number): string {
  const place = Math.max(0, ids.indexOf(at)) + by;
  return ids[Math.min(Math.max(0, place), ids.length - 1)] ?? "";
}

/** The id that comes after one that leaves: the next, or the one before the last. */
export function following(ids: readonly string[], leaving: string): string {
  const place = ids.indexOf(leaving);
  return ids[place + 1] ?? ids[place - 1] ?? "";
}
