"""Finds the skeleton (ASF file) of each motion (AMC file) of an import by their names.

CMU's names are `07.asf` and `07_01.amc`, HDM05's `HDM_bd.asf` and `HDM_bd_01-01.amc`: the stem of
the motion begins with the stem of the skeleton. An archive has no other information on pairs. The
readers check the contents later.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable
from pathlib import Path
from posixpath import splitext

MAX_CUTS = 30
"""Largest number of words that are removed from the end of a motion's stem."""

_Folder = tuple[str, ...]


def pair_skeletons(paths: Iterable[str]) -> dict[str, str]:
    """The ASF path of each AMC path. An AMC file without a clear skeleton is left out.

    The rules, in this order: the ASF file in the same folder with the longest stem that the AMC's
    stem begins with; the only ASF file of the same folder; the ASF file of the nearest folder,
    again with the longest such stem.
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


def skeleton_beside(path: Path) -> Path | None:
    """The ASF file in the folder of a single AMC file that is its skeleton."""
    if path.suffix.lower() != ".amc":
        return None
    names = [other.name for other in path.parent.iterdir() if other.suffix.lower() == ".asf"]
    name = pair_skeletons([path.name, *sorted(names)]).get(path.name)
    return None if name is None else path.parent / name


class _Skeletons:
    """The skeletons of an import, by folder and by stem.

    An import may have very many skeletons and motions, so no search visits all skeletons.
    """

    def __init__(self) -> None:
        self._in_folder: dict[_Folder, list[str]] = {}
        self._named: dict[tuple[_Folder, str], str] = {}
        self._by_stem: dict[str, list[tuple[_Folder, str]]] = {}

    def add(self, path: str) -> None:
        """Add a skeleton. If two in one folder have the same stem, the first one counts."""
        folder, stem = _parts(path)
        self._in_folder.setdefault(folder, []).append(path)
        self._named.setdefault((folder, stem), path)
        self._by_stem.setdefault(stem, []).append((folder, path))

    def sort(self) -> None:
        """Sort the skeletons of each stem by folder. Call it after all were added."""
        for same_stem in self._by_stem.values():
            same_stem.sort()

    def of(self, motion: str) -> str | None:
        """The skeleton of a motion; None if it is not clear."""
        folder, whole = _parts(motion)
        stems = _shortened_stems(whole)
        for stem in stems:
            if (folder, stem) in self._named:
                return self._named[folder, stem]
        same_folder = self._in_folder.get(folder, ())
        if len(same_folder) == 1:
            return same_folder[0]
        for stem in stems:
            if stem in self._by_stem:
                return _nearest(folder, self._by_stem[stem])
        return None


def _shortened_stems(stem: str) -> list[str]:
    """The stem, then the stem without its last word, its last two words, and so on."""
    cuts = [i for i in range(len(stem) - 1, 0, -1) if not stem[i].isalnum()]
    return [stem] + [stem[:cut] for cut in cuts[:MAX_CUTS]]


def _nearest(folder: _Folder, sorted_skeletons: list[tuple[_Folder, str]]) -> str | None:
    """The skeleton that shares most parent folders with `folder`; None if several share as many."""
    # In sorted order, the skeletons that share most are next to the index of `folder`. Two on each
    # side are enough to see whether the nearest one is the only one.
    at = bisect_left(sorted_skeletons, (folder, ""))
    around = sorted_skeletons[max(at - 2, 0) : at + 2]
    shared = [_shared(folder, other) for other, _ in around]
    largest = max(shared)
    nearest = [path for (_, path), count in zip(around, shared, strict=True) if count == largest]
    return nearest[0] if len(nearest) == 1 else None


def _shared(first: _Folder, second: _Folder) -> int:
    """The number of folders, from the root, that two paths have in common."""
    pairs = zip(first, second, strict=False)
    return next((i for i, (a, b) in enumerate(pairs) if a != b), min(len(first), len(second)))


def _parts(path: str) -> tuple[_Folder, str]:
    """The folder of a path, and its stem in lower case."""
    folder, _, name = path.rpartition("/")
    return tuple(folder.split("/")) if folder else (), splitext(name)[0].lower()
