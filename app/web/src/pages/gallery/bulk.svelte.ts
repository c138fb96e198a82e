/** Labels and deletes many clips at once, says what was done, and offers to take it back. */
import type { Clip } from "$/api/client";
import { inWords } from "$/api/problem";
import { count, plural } from "$/core/format";
import { notices } from "$/ui/notices.svelte";
import { deleteAll, patchAll, patchFor, undoing, type Labeled, type Labels } from "./changes";

export interface BulkEvents {
  /** Clips have other labels now. */
  readonly onchanged: (clips: readonly Clip[]) => void;
  readonly ondeleted: (ids: ReadonlySet<string>) => void;
}

export class Bulk {
  /** How many clips are done while some are labeled, else null. */
  progress: number | null = $state(null);
  /** Clips that nobody sees while their deletion can be taken back. */
  hidden: ReadonlySet<string> = $state.raw(new Set());
  readonly #told: BulkEvents;

  constructor(told: BulkEvents) {
    this.#told = told;
  }

  async label(clips: readonly Labeled[], labels: Labels): Promise<void> {
    const patches = clips
      .map((clip) => ({ clip, id: clip.id, patch: patchFor(clip, labels) }))
      .filter(({ patch }) => Object.keys(patch).length > 0);
    this.progress = 0;
    const { changed, failures } = await patchAll(patches, (done) => (this.progress = done));
    this.progress = null;
    this.#told.onchanged(changed);
    const ids = new Set(changed.map(({ id }) => id));
    const back = patches
      .filter(({ id }) => ids.has(id))
      .map(({ clip, id, patch }) => ({ id, patch: undoing(clip, patch) }));
    notices.show(`${plural(changed.length, "clip")} labeled.${reason(failures)}`, {
      action: {
        label: "Undo",
        run: () => void patchAll(back).then((undone) => this.#told.onchanged(undone.changed)),
      },
    });
  }

  /**
   * Clips vanish at once; the service is told when the time to take it back is over.
   *
   * onback: called when it is taken back.
   */
  remove(ids: readonly string[], onback: () => void = () => undefined): void {
    this.hidden = new Set([...this.hidden, ...ids]);
    const show = (): void => {
      this.hidden = new Set([...this.hidden].filter((id) => !ids.includes(id)));
    };
    notices.show(`${plural(ids.length, "clip")} deleted.`, {
      action: {
        label: "Undo",
        run: () => {
          show();
          onback();
        },
      },
      expire: () =>
        void deleteAll(ids).then((failures) => {
          if (failures.length > 0) notices.show(`Not all were deleted.${reason(failures)}`);
          this.#told.ondeleted(new Set(ids));
          show();
        }),
    });
  }
}

function reason(failures: readonly unknown[]): string {
  if (failures.length === 0) return "";
  return ` ${count(failures.length)} failed: ${inWords(failures[0]).join(" ")}`;
}
