"""The plan of an import: which files are motions, and the manifest row, skeleton, recording and
annotations of each.

A manifest describes motions and names their recordings. An ASF file is the skeleton of the AMC
files that `skeleton_pairs` finds for it. This module reads manifests only.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from app.errors import BadContent, TooLarge, Unreadable
from app.formats.annotations.span import Span
from app.kinedex_error import KinedexError, Place
from app.services.fields import MAX_PATH, bad_field
from app.services.fields import path as clip_path
from app.services.imports.annotations import AnnotationFiles, is_table
from app.services.imports.manifest import Manifest, ManifestRow
from app.services.imports.manifest_table import MANIFEST_NAME, ManifestLimits
from app.services.imports.options import ImportOptions
from app.services.imports.skeleton_pairs import pair_skeletons
from app.services.imports.skipped import is_called_motion
from app.services.imports.sources import SourceFile

MAX_ABSENT_LISTED = 100
"""How many missing files of manifests are reported one by one; the others are only counted."""


@dataclass(frozen=True, slots=True)
class Item:
    """A motion file of an import, with its manifest row, skeleton file and recording.

    beside: a file of its annotations; spans: those of tables.
    """

    file: SourceFile
    row: ManifestRow
    skeleton: SourceFile | None
    sound: SourceFile | None
    beside: SourceFile | None = None
    spans: Sequence[Span] = ()


class Plan:
    """What an import does with its files.

    motions: the files that may become clips; absent: the problems of the first
    MAX_ABSENT_LISTED paths that a manifest names and that are missing; absent_count: how many paths
    are missing; paths: of the motions, as clips have them; unmatched: how many motions the pattern
    of the options does not match.
    """

    def __init__(
        self,
        files: Iterable[SourceFile],
        limits: ManifestLimits,
        options: ImportOptions | None = None,
    ) -> None:
        """Sort the files into motions and their companions.

        Raises Unreadable and TooLarge for a bad manifest or table of annotations, a manifest
        file's own problem, and BadField for bad options, or a pattern that matches no motion.
        """
        self.options = options or ImportOptions()
        self._by_path = {file.path: file for file in _with_unique_paths(files)}
        self._manifest = Manifest(limits, self.options)
        _read_manifests(self._manifest, self._by_path.values())
        self._skeletons = pair_skeletons(self._by_path)
        self._annotations = AnnotationFiles.among(self._by_path.values())
        recordings = self._manifest.recordings()
        taken = {*self._skeletons.values(), *recordings, *self._annotations.paths}
        self.motions = tuple(
            file
            for file in self._by_path.values()
            if not (_is_manifest(file) or is_table(file)) and file.path not in taken
        )
        self.paths = frozenset(filter(None, map(_clip_path, self.motions)))
        self.unmatched = self._count_unmatched()
        absent = {path: line for path, line in self._manifest.named() if path not in self._by_path}
        self.absent_count = len(absent)
        self.absent = {
            path: _absent(path, absent[path]) for path in heapq.nsmallest(MAX_ABSENT_LISTED, absent)
        }

    def _count_unmatched(self) -> int:
        motions = [file.path for file in self.motions if is_called_motion(file.path)]
        matched = sum(map(self._manifest.is_matched, motions))
        if motions and not matched:
            example = f"a path is {motions[0]!r}; **/ stands for any folders"
            raise bad_field("labels", f"the pattern matches no file; {example}")
        return len(motions) - matched

    def item(self, motion: SourceFile) -> Item:
        """A motion with its manifest row, skeleton, recording and annotations."""
        row = self._manifest.row(motion.path)
        skeleton = self._skeletons.get(motion.path)
        return Item(
            motion,
            row,
            None if skeleton is None else self._by_path[skeleton],
            self._by_path.get(row.audio or ""),
            self._annotations.of(motion),
            self._annotations.rows.get(motion.path, ()),
        )


def _read_manifests(manifest: Manifest, files: Iterable[SourceFile]) -> None:
    """Read all manifests among the files. A bad manifest fails the whole import."""
    for file in files:
        if _is_manifest(file):
            _read_manifest(manifest, file)


def _clip_path(file: SourceFile) -> str | None:
    return None if file.problem is not None else clip_path(file.path)


def _read_manifest(manifest: Manifest, file: SourceFile) -> None:
    # An encrypted or damaged manifest must not be skipped: its labels would be lost silently.
    if file.problem is not None:
        raise file.problem
    try:
        with file.open() as content:
            manifest.read(content, file.path.rpartition("/")[0])
    except (Unreadable, TooLarge) as problem:
        rest = problem.detail.removeprefix(MANIFEST_NAME)
        detail = f"{file.path}{rest}" if rest != problem.detail else f"{file.path}: {rest}"
        raise type(problem)(detail, places=problem.places) from problem


def _is_manifest(file: SourceFile) -> bool:
    return file.path.rpartition("/")[2] == MANIFEST_NAME


def _with_unique_paths(files: Iterable[SourceFile]) -> Iterable[SourceFile]:
    """The files with paths that can be stored. A repeated path gets a number: "a.bvh (2)"."""
    used: set[str] = set()
    count: dict[str, int] = {}
    for original in files:
        file = _with_storable_path(original)
        path = file.path
        while path in used:
            count[file.path] = count.get(file.path, 1) + 1
            path = f"{file.path} ({count[file.path]})"
        used.add(path)
        yield file if path == file.path else replace(file, path=path)


def _with_storable_path(file: SourceFile) -> SourceFile:
    """The file with a path of valid Unicode; a path that is too long is cut and a problem."""
    # A file name on disk may hold bytes that are not UTF-8; the database cannot store them.
    path = file.path.encode("utf-8", "replace").decode()
    if len(path) > MAX_PATH:
        half = MAX_PATH // 2 - 20
        message = f"{len(path)} characters, the limit is {MAX_PATH}"
        path = f"{path[:half]}…{path[-half:]}"
        problem = BadContent("The path is too long.", places=[Place(path, message)])
        return replace(file, path=path, problem=problem)
    return file if path == file.path else replace(file, path=path)


def _absent(path: str, line: int) -> KinedexError:
    place = Place(f"{MANIFEST_NAME} line {line}", f"{path} does not exist")
    return BadContent("The manifest names a file that does not exist.", places=[place])
