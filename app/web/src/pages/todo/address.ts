/** The queue's state in its address, and the clips that are in it. */
import type { ClipQuery } from "$/pages/gallery/address";
import { choice, number, text, type Values } from "$/core/query";
import { PLAYER } from "$/player/view";

export const KINDS = {
  doubts: "Doubts",
  failed: "Failed",
  duplicates: "Duplicates",
  outliers: "Outliers",
  unlabeled: "Without labels",
} as const;
export type Kind = keyof typeof KINDS;
/** Kinds whose work is one clip after the other. */
export type ClipKind = Exclude<Kind, "duplicates" | "outliers">;

export function isClipKind(kind: Kind): kind is ClipKind {
  return kind !== "duplicates" && kind !== "outliers";
}

/** How two clips are the same. */
export const PAIRS = {
  exact: "the same poses",
  copy: "with noise or cleaned",
  rate: "at another frame rate",
  format: "in another format or skeleton",
  cut: "a part",
  mirror: "mirrored",
  similar: "another take, almost the same",
} as const;

/** The API's limit, and that of the distance of takes that are almost the same. */
export const MAX_OUTLIERS = 1000;
const MAX_THRESHOLD = 0.5;

/** What another clip of the queue sets in the player. */
export const FROM_START = { t: 0, from: null, to: null } as const;

export const LACKS = { task: "a task", person: "a person", words: "words" } as const;
export type Lack = keyof typeof LACKS;

export const TODO = {
  ...PLAYER,
  /** any: the first kind that has clips. */
  kind: choice(["any", ...(Object.keys(KINDS) as Kind[])], "any"),
  lacks: choice(Object.keys(LACKS) as Lack[], "task"),
  /** How far takes may be apart that count as almost the same; 0: copies only. */
  threshold: number(0, 0, MAX_THRESHOLD),
  /** Place of the clip that stands beside the first one. */
  beside: number(1, 1, MAX_OUTLIERS),
  /** Id of the clip or the group that is looked at; the first one where there is none. */
  at: text(),
};
export type TodoValues = Values<typeof TODO>;

/** The clips of a kind, as the API takes it. */
export function queueQuery(kind: ClipKind, lacks: Lack): ClipQuery {
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
