"""What the files of an import are to each other: motions, and what goes with each.

A manifest tells of motions and names their recordings; an ASF file is the skeleton of the AMC
files beside it. Nothing but manifests is read here.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from app.errors import BadContent, KinedexError, Place, Unreadable
from app.services.companions import pair_skeletons
from app.services.import_sources import SourceFile
from app.services.manifest import MANIFEST_NAME, ManifestRow, read_manifest

_NOTHING = ManifestRow(line=0)


@dataclass(frozen=True, slots=True)
class Item:
    """A motion file of an import with what goes with it."""

    file: SourceFile
    row: ManifestRow
    skeleton: SourceFile | None
    sound: SourceFile | None


@dataclass(frozen=True, slots=True)
class Plan:
    """items: what may become a clip each; absent: why by path, of what a manifest names only."""

    items: tuple[Item, ...]
    absent: dict[str, KinedexError]


def plan_import(files: Iterable[SourceFile]) -> Plan:
    """Sort the files of an import. Raises Unreadable, and what is wrong with a manifest."""
    listed = _each_once(files)
    by_path = {file.path: file for file in listed}
    manifest, skeletons = _manifest_rows(listed), _skeletons(listed)
    sounds = {row.audio: row for row in manifest.values() if row.audio is not None}
    taken = {skeleton.path for skeleton in skeletons.values()} | sounds.keys()
    rows = (manifest.get(file.path, _NOTHING) for file in listed)
    items = (
        Item(file, row, skeletons.get(file.path), by_path.get(row.audio or ""))
        for file, row in zip(listed, rows, strict=True)
        if not _is_manifest(file) and file.path not in taken
    )
    named = sounds | manifest
    absent = sorted(named.keys() - by_path.keys())
    return Plan(tuple(items), {path: _absent(path, named[path]) for path in absent})


def _manifest_rows(files: Iterable[SourceFile]) -> dict[str, ManifestRow]:
    """What every manifest among the files says, by path; a bad one fails the whole import."""
    rows: dict[str, ManifestRow] = {}
    for file in files:
        if _is_manifest(file):
            rows |= read_manifest(_content(file), file.path.rpartition("/")[0])
    return rows


def _content(manifest: SourceFile) -> bytes:
    # One that is encrypted or damaged must not be passed over: its labels would be lost.
    if manifest.problem is not None:
        raise manifest.problem
    try:
        with manifest.open() as content:
            return content.read()
    except Unreadable as problem:
        raise Unreadable(f"{manifest.path}: {problem.detail}") from problem


def _skeletons(files: Iterable[SourceFile]) -> dict[str, SourceFile]:
    """The file of the skeleton that each AMC file moves, by the AMC's path."""
    by_path = {file.path: file for file in files}
    return {motion: by_path[path] for motion, path in pair_skeletons(by_path).items()}


def _is_manifest(file: SourceFile) -> bool:
    return file.path.rpartition("/")[2] == MANIFEST_NAME


def _each_once(files: Iterable[SourceFile]) -> list[SourceFile]:
    """The files with paths that are storable, and different where an archive repeats one."""
    seen: dict[str, int] = {}
    listed = []
    for file in files:
        path = file.path.encode("utf-8", "replace").decode()
        seen[path] = seen.get(path, 0) + 1
        name = path if seen[path] == 1 else f"{path} ({seen[path]})"
        listed.append(replace(file, path=name))
    return listed


def _absent(path: str, row: ManifestRow) -> KinedexError:
    place = Place(f"{MANIFEST_NAME} line {row.line}", f"{path} is not there")
    return BadContent("The manifest names a file that is not there.", places=[place])
