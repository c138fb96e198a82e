"""A collection as a ZIP: a file an item, a manifest, the licenses and the credits.

The ZIP is made piece by piece, so that a large collection is never in memory. An item that cannot
be exported is left out, and `left_out.csv` says why.
"""

from __future__ import annotations

import csv
import io
import zipfile
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

from app.deadline import check
from app.formats.csv.formulas import guarded
from app.services.collections.collections import Item, all_items, get
from app.services.library.library import Library
from app.services.views.clip_parts import Part
from app.services.views.export import export
from app.services.views.export_format import ExportFormat
from app.services.views.export_many import LEFT_OUT
from app.services.views.export_options import checked_options
from app.services.views.exported import Export
from app.store.clips.metadata_values import as_cell
from app.store.clips.record import META

NO_LICENSE = "no license is stored"
NO_SOURCE = "no source is stored"
TIME = (1980, 1, 1, 0, 0, 0)
"""The time of all files: the same collection gives the same bytes."""
COLUMNS = ("path", "name", "person", "task", "words", "license", "source", "captions")
PART_COLUMNS = ("clip_id", "part_start", "part_end", "item_notes")
"""Become metadata of the clips, if the ZIP is imported."""


@dataclass(frozen=True, slots=True)
class _Written:
    """An item that is in the ZIP, and the path of its file."""

    item: Item
    path: str


def export_collection(
    lib: Library, collection_id: str, format: ExportFormat | str, **options: Any
) -> Export:
    """A collection as a ZIP. options: those of `export` without content, reduction and part.

    Raises CollectionNotFound, BadField.
    """
    checked = checked_options(format, **options)
    record, items = get(lib, collection_id), all_items(lib, collection_id)
    stem = "".join(c if c.isalnum() or c in " ._-" else "_" for c in record.name).strip(" ._")
    unit = checked.unit.value
    name = f"{stem[:100] or record.id}.zip"
    return Export(name, _zip(lib, items, checked.format, unit, options))


def _zip(
    lib: Library,
    items: Sequence[Item],
    format: ExportFormat,
    unit: str,
    options: Mapping[str, Any],
) -> Iterator[bytes]:
    sink = _Sink()
    written: list[_Written] = []
    left_out: list[tuple[str, str]] = []
    with zipfile.ZipFile(sink, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        digits = len(str(len(items)))
        for number, item in enumerate(items, start=1):
            check()
            try:
                file = export(lib, item.clip.id, format, part=_part(item), **options)
            except LEFT_OUT as failure:
                left_out.append((item.clip.id, failure.detail))
                continue
            # the number keeps the order, and makes the names of two parts of a clip differ
            path = f"{number:0{digits}} {PurePath(file.file_name).stem}{_ending(item)}.{format}"
            yield from _entry(archive, sink, path, file.blocks)
            written.append(_Written(item, path))
        texts = {
            "manifest.csv": _manifest(written, unit),
            "LICENSES.txt": _licenses(written),
            "CREDITS.txt": _credits(written),
        }
        if left_out:
            texts["left_out.csv"] = _table([("clip_id", "reason"), *left_out])
        for path, text in texts.items():
            yield from _entry(archive, sink, path, [text.encode()])
    yield sink.taken()


def _part(item: Item) -> Part | None:
    if item.record.start is None and item.record.end is None:
        return None
    return Part(item.record.start or 0.0, item.record.end)


def _ending(item: Item) -> str:
    part = _part(item)
    if part is None:
        return ""
    end = "end" if part.end is None else f"{part.end:.2f}"
    return f" {part.start:.2f}-{end}"


def _entry(
    archive: zipfile.ZipFile, sink: _Sink, path: str, blocks: Iterable[bytes]
) -> Iterator[bytes]:
    entry = zipfile.ZipInfo(path, TIME)
    entry.compress_type = zipfile.ZIP_DEFLATED
    entry.external_attr = 0o644 << 16
    with archive.open(entry, "w", force_zip64=True) as file:
        for block in blocks:
            file.write(block)
            if piece := sink.taken():
                yield piece
    yield sink.taken()


def _manifest(written: Sequence[_Written], unit: str) -> str:
    keys = sorted({key for one in written for key in one.item.clip.metadata})
    head = [*COLUMNS, "unit", *(META + key for key in keys), *(META + c for c in PART_COLUMNS)]
    return _table([head, *(_row(one, unit, keys) for one in written)])


def _row(one: _Written, unit: str, keys: Sequence[str]) -> list[str]:
    clip, record = one.item.clip, one.item.record
    texts = (one.path, clip.name, clip.person, clip.task, " ".join(clip.words), clip.license)
    values = [clip.metadata.get(key, "") for key in keys]
    return [
        *(guarded(text or "") for text in (*texts, clip.source, " | ".join(clip.captions))),
        unit,
        *(guarded(as_cell(one)) if isinstance(one, str) else as_cell(one) for one in values),
        clip.id,
        "" if record.start is None else f"{record.start:g}",
        "" if record.end is None else f"{record.end:g}",
        guarded(" ".join(record.notes.split())),
    ]


def _licenses(written: Sequence[_Written]) -> str:
    """Each license with the files that have it."""
    by_license: dict[str, list[str]] = defaultdict(list)
    for one in written:
        by_license[one.item.clip.license or NO_LICENSE].append(one.path)
    parts = [
        f"{license} ({len(paths)}):\n" + "".join(f"  {path}\n" for path in paths)
        for license, paths in sorted(by_license.items())
    ]
    return "\n".join(parts) or "There are no files.\n"


def _credits(written: Sequence[_Written]) -> str:
    """Each source with its licenses, its persons and how many files come from it."""
    by_source: dict[str, list[Item]] = defaultdict(list)
    for one in written:
        by_source[one.item.clip.source or NO_SOURCE].append(one.item)
    lines = ["This collection contains motions of:", ""]
    for source, items in sorted(by_source.items()):
        lines.append(f"{source}: {len(items)} files")
        licenses = Counter(item.clip.license or NO_LICENSE for item in items)
        lines += [f"  license: {name} ({count})" for name, count in sorted(licenses.items())]
        persons = sorted({item.clip.person for item in items if item.clip.person})
        lines += [f"  performed by: {', '.join(persons)}"] if persons else []
    return "\n".join(lines) + "\n"


def _table(rows: Iterable[Sequence[str]]) -> str:
    text = io.StringIO(newline="")
    csv.writer(text).writerows(rows)
    return text.getvalue()


class _Sink(io.RawIOBase):
    """Keeps what is written until it is taken. It cannot seek."""

    def __init__(self) -> None:
        super().__init__()
        self._parts: list[bytes] = []

    def writable(self) -> bool:
        return True

    def write(self, content: Any) -> int:
        """Keep bytes; returns their number."""
        self._parts.append(bytes(content))
        return len(content)

    def taken(self) -> bytes:
        """What was written since the last call."""
        parts, self._parts = self._parts, []
        return b"".join(parts)
