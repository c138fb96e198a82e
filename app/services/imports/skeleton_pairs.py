"""Which ASF file among an import's files is the skeleton of which AMC file, by their names.

CMU calls them `07.asf` and `07_01.amc`, others `HDM_bd.asf` and `HDM_bd_01-01.amc`: the
skeleton's stem begins the motion's. Names are all that an archive has; contents decide
afterwards whether the files are what they are called.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable
from posixpath import splitext

MAX_CUTS = 30
"""Words that are cut off a motion's stem in search of its skeleton's."""

_Folder = tuple[str, ...]


def pair_skeletons(paths: Iterable[str]) -> dict[str, str]:
    """The ASF path of each AMC path, of those whose skeleton is clear.

    In the AMC's own folder first, then in the folders nearest to it; in each the ASF whose
    stem begins the AMC's stem furthest, else the only one of the AMC's own folder.
    """
    motions, skeletons = [], _Skeletons()
    for path in paths:
        suffix = splitext(path)[1].lower()
        if suffix == ".amc":
            motions.append(path)
        elif suffix == ".asf":
            skeletons.add(path)
    skeletons.sort()
    found = {motion: skeletons.of(motion) for motion in motions}
    return {motion: skeleton for motion, skeleton in found.items() if skeleton is not None}


class _Skeletons:
    """The skeletons of an import, found without a walk over all of them: there may be very many,
    and a motion for each."""

    def __init__(self) -> None:
        self._in_folder: dict[_Folder, list[str]] = {}
        self._named: dict[tuple[_Folder, str], str] = {}
        self._by_stem: dict[str, list[tuple[_Folder, str]]] = {}

    def add(self, path: str) -> None:
        """Add a skeleton; of two in one folder with one stem the first counts there."""
        folder, stem = _parts(path)
        self._in_folder.setdefault(folder, []).append(path)
        self._named.setdefault((folder, stem), path)
        self._by_stem.setdefault(stem, []).append((folder, path))

    def sort(self) -> None:
        """Call it once all are added."""
        for alike in self._by_stem.values():
            alike.sort()

    def of(self, motion: str) -> str | None:
        """The skeleton of a motion, if it is clear."""
        folder, whole = _parts(motion)
        stems = _beginnings(whole)
        for stem in stems:
            if (folder, stem) in self._named:
                return self._named[folder, stem]
        beside = self._in_folder.get(folder, ())
        if len(beside) == 1:
            return beside[0]
        for stem in stems:
            if stem in self._by_stem:
                return _nearest(folder, self._by_stem[stem])
        return None


def _beginnings(stem: str) -> list[str]:
    """The stem, and what is left of it where words at its end are cut off, longest first."""
    cuts = [i for i in range(len(stem) - 1, 0, -1) if not stem[i].isalnum()]
    return [stem] + [stem[:cut] for cut in cuts[:MAX_CUTS]]


def _nearest(folder: _Folder, sorted_skeletons: list[tuple[_Folder, str]]) -> str | None:
    """The skeleton that shares most folders with a motion's; None where several do."""
    # Those that share most stand together in the order, around where the folder would stand.
    at = bisect_left(sorted_skeletons, (folder, ""))
    around = sorted_skeletons[max(at - 2, 0) : at + 2]
    shared = [_shared(folder, other) for other, _ in around]
    most = max(shared)
    nearest = [path for (_, path), count in zip(around, shared, strict=True) if count == most]
    return nearest[0] if len(nearest) == 1 else None


def _shared(ours: _Folder, theirs: _Folder) -> int:
    """How many folders from the top two places have in common."""
    pairs = zip(ours, theirs, strict=False)
    return next((i for i, (a, b) in enumerate(pairs) if a != b), min(len(ours), len(theirs)))


def _parts(path: str) -> tuple[_Folder, str]:
    folder, _, name = path.rpartition("/")
    return tuple(folder.split("/")) if folder else (), splitext(name)[0].lower()
