/** Files as people hand them in: chosen, or dropped with whole folders. */

export interface Found {
  /** Where the file is in what was handed in, as folder/name. */
  readonly path: string;
  readonly file: File;
}

/** Files that systems put into folders by themselves. */
const NOISE = /(^|\/)(\.|__MACOSX\/|Thumbs\.db$|desktop\.ini$)/;

export function fromInput(files: Iterable<File>): readonly Found[] {
  return useful([...files].map((file) => ({ path: file.webkitRelativePath || file.name, file })));
}

/** All files of a drop, those in folders too. Call it in the event: items are gone afterwards. */
export async function fromDrop(transfer: DataTransfer): Promise<readonly Found[]> {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry());
  const found = await Promise.all(entries.filter((entry) => entry !== null).map(within));
  return useful(found.flat());
}

export function useful(found: readonly Found[]): readonly Found[] {
  return found.filter(({ path }) => !NOISE.test(path));
}

async function within(entry: FileSystemEntry): Promise<readonly Found[]> {
  if (entry.isFile) {
    const file = await new Promise<File>((take, fail) =>
      (entry as FileSystemFileEntry).file(take, fail),
    );
    return [{ path: entry.fullPath.slice(1), file }];
  }
  const found: (readonly Found[])[] = [];
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  // A reader gives some entries at a time, and none at the end.
  for (;;) {
    const some = await new Promise<FileSystemEntry[]>((take, fail) =>
      reader.readEntries(take, fail),
    );
    if (some.length === 0) return found.flat();
    for (const each of some) found.push(await within(each));
  }
}
