"""Annotations that come with the files of an import.

- `kick.eaf` beside `kick.bvh`: annotations of ELAN.
- `kick.babel.json` beside `kick.bvh`: those of BABEL.
- `annotations.csv` in any folder: a table, whose column `clip` has paths relative to that folder.
"""

from __future__ import annotations

import hashlib
import posixpath
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from app.errors import TooLarge, Unreadable
from app.formats.annotations import babel, eaf, table
from app.formats.annotations.span import MAX_FILE_BYTES, Span
from app.kinedex_error import KinedexError, Place
from app.services.annotations.checks import of_spans
from app.services.clips.merging import OnConflict
from app.services.imports.sources import SourceFile
from app.store.clips import clip_annotations as stored
from app.store.clips import repository as clips
from app.store.clips.clip_annotations import NewAnnotation
from app.store.clips.record import ClipRecord, Difference
from app.store.database.engine import Tx

TABLE_NAME = "annotations.csv"
ENDINGS = (".eaf", ".babel.json")
FIELD = "annotations"


@dataclass(slots=True)
class AnnotationFiles:
    """The annotations among the files of an import.

    beside: the file of a motion's annotations, by the path of the motion without its ending;
    rows: those of tables, by the path of the motion.
    """

    beside: dict[str, SourceFile] = field(default_factory=dict)
    rows: dict[str, list[Span]] = field(default_factory=dict)

    @classmethod
    def among(cls, files: Iterable[SourceFile]) -> AnnotationFiles:
        """Find the files of annotations, and read the tables.

        Raises Unreadable and TooLarge for a bad table, as for a bad manifest.
        """
        found, stems = cls(), dict[str, SourceFile]()
        motions = set()
        for file in files:
            name = file.path.lower()
            ending = next((one for one in ENDINGS if name.endswith(one)), None)
            if ending is not None:
                stems[file.path[: -len(ending)]] = file
            elif is_table(file):
                found.read_table(file)
            else:
                motions.add(posixpath.splitext(file.path)[0])
        found.beside = {stem: file for stem, file in stems.items() if stem in motions}
        return found

    @property
    def paths(self) -> frozenset[str]:
        """The paths of all files that go with motions."""
        return frozenset(file.path for file in self.beside.values())

    def of(self, motion: SourceFile) -> SourceFile | None:
        """The file of annotations beside a motion."""
        return self.beside.get(posixpath.splitext(motion.path)[0])

    def read_table(self, file: SourceFile) -> None:
        """Add the rows of a table. Raises its problem, Unreadable, TooLarge."""
        if file.problem is not None:
            raise file.problem
        folder = file.path.rpartition("/")[0]
        try:
            for clip, span in table.read_table(_content(file)):
                path = posixpath.normpath(posixpath.join(folder, clip))
                self.rows.setdefault(path, []).append(span)
        except (Unreadable, TooLarge) as problem:
            detail = f"{file.path}: {problem.detail}"
            raise type(problem)(detail, places=problem.places) from problem


def is_table(file: SourceFile) -> bool:
    """Whether a file is a table of annotations."""
    return file.path.rpartition("/")[2] == TABLE_NAME


def read_beside(file: SourceFile) -> tuple[NewAnnotation, ...]:
    """The annotations in a file beside a motion. Raises a KinedexError that names the file."""
    if file.problem is not None:
        raise file.problem
    try:
        content = _content(file)
        if file.path.lower().endswith(".eaf"):
            return of_spans(eaf.read_eaf(content), None)
        sequences = babel.read_babel(content)
        if len(sequences) != 1:
            place = Place(file.path, f"{len(sequences)} sequences")
            raise Unreadable("A file beside a motion holds one sequence.", places=[place])
        return of_spans(sequences[0].spans, None)
    except KinedexError as problem:
        raise type(problem)(f"{file.path}: {problem.detail}", places=problem.places) from problem


def put_annotations(
    tx: Tx, clip: ClipRecord, new: Sequence[NewAnnotation], policy: OnConflict
) -> tuple[Difference, ...]:
    """Store the annotations that came with a clip, by the rules of `merging`.

    Returns the difference in their number from the stored ones. It is empty if they are equal, or
    if the policy is MERGE and the same annotations came before.
    """
    old = stored.get_many(tx, [clip.id]).get(clip.id, ())
    sent, ours, base = _digest(new), _digest(old), clip.imported.get(FIELD)
    is_same = sent == ours
    if not is_same and policy is OnConflict.MERGE and sent == base:
        return ()
    is_unedited = base == ours or not old
    is_applied = policy is OnConflict.UPDATE or (policy is OnConflict.MERGE and is_unedited)
    if is_applied and not is_same:
        stored.put(tx, clip.id, new)
    if is_applied or is_same:
        clips.patch(tx, clip.id, {"imported": {**clip.imported, FIELD: sent}})
    return () if is_same else (Difference(FIELD, len(old), len(new), is_applied),)


def _digest(found: Sequence[NewAnnotation]) -> str:
    """A digest of what annotations say. No name of a person can be read from it."""
    said = [(one.start, one.end, one.words, one.person, one.text, one.by) for one in found]
    return hashlib.sha256(repr(sorted(said, key=repr)).encode()).hexdigest()


def _content(file: SourceFile) -> bytes:
    with file.open() as opened:
        content = opened.read(MAX_FILE_BYTES + 1)
    if len(content) > MAX_FILE_BYTES:
        raise TooLarge(f"A file of annotations has at most {MAX_FILE_BYTES} bytes.")
    return content
