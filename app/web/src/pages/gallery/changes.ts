/** Changes of many clips at once, which can be taken back. */
import { api, ask, type Clip, type Schemas } from "$/api/client";
import { forEachOf } from "$/core/pool";

const AT_ONCE = 4;

export interface Labels {
  /** undefined: as it is; null: none. */
  person?: string | null;
  task?: string | null;
  add: readonly string[];
  remove: readonly string[];
}

/** What has to be known of a clip to label it. */
export type Labeled = Pick<Clip, "id" | "person" | "task" | "words">;

export type Patch = Schemas["ClipPatch"];

export interface Outcome {
  readonly changed: readonly Clip[];
  readonly failures: readonly unknown[];
}

/** What has to change of a clip; empty where it has these labels already. */
export function patchFor(clip: Labeled, labels: Labels): Patch {
  const patch: Patch = {};
  if (labels.person !== undefined && labels.person !== clip.person) patch.person = labels.person;
  if (labels.task !== undefined && labels.task !== clip.task) patch.task = labels.task;
  const words = [...new Set([...clip.words, ...labels.add])].filter(
    (word) => !labels.remove.includes(word),
  );
  if (words.join(" ") !== clip.words.join(" ")) patch.words = words;
  return patch;
}

/** The patch that takes another one back. */
export function undoing(clip: Labeled, patch: Patch): Patch {
  const names = Object.keys(patch) as (keyof Patch & keyof Labeled)[];
  return Object.fromEntries(names.map((name) => [name, clip[name]]));
}

/** Words as people type them: separated by commas or spaces, a phrase with underscores. */
export function words(typed: string): readonly string[] {
  return typed.split(/[\s,]+/).filter(Boolean);
}

export async function patchAll(
  patches: readonly { id: string; patch: Patch }[],
  ondone: (count: number) => void = () => undefined,
): Promise<Outcome> {
  const changed: Clip[] = [];
  const failures = await forEachOf(patches, AT_ONCE, async ({ id, patch }) => {
    const params = { path: { clip_id: id } };
    changed.push(await ask(api.PATCH("/v1/clips/{clip_id}", { params, body: patch })));
    ondone(changed.length);
  });
  return { changed, failures: failures.map(({ failure }) => failure) };
}

/** Delete clips; the calls go on when the page is left. */
export async function deleteAll(ids: readonly string[]): Promise<readonly unknown[]> {
  const failures = await forEachOf(ids, AT_ONCE, async (id) => {
    const params = { path: { clip_id: id } };
    await ask(api.DELETE("/v1/clips/{clip_id}", { params, keepalive: true }));
  });
  return failures.map(({ failure }) => failure);
}
