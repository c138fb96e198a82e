"""Which ASF file among an import's files is the skeleton of which AMC file, by their names.

CMU calls them `07.asf` and `07_01.amc`, others `HDM_bd.asf` and `HDM_bd_01-01.amc`: the
skeleton's stem begins the motion's. Names are all that an archive has; contents decide
afterwards whether the files are what they are called.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import PurePosixPath


def pair_skeletons(paths: Iterable[str]) -> dict[str, str]:
    """The ASF path of each AMC path, of those whose skeleton is clear.

    In the AMC's own folder first, then in the folders nearest to it; in each the ASF whose
    stem begins the AMC's stem furthest, else the only one of the AMC's own folder.
    """
    motions, skeletons = [], []
    for path in paths:
        suffix = PurePosixPath(path).suffix.lower()
        if suffix == ".amc":
            motions.append(path)
        elif suffix == ".asf":
            skeletons.append(path)
    by_folder: dict[str, list[str]] = {}
    by_stem: dict[str, list[str]] = {}
    for skeleton in skeletons:
        by_folder.setdefault(_folder(skeleton), []).append(skeleton)
        by_stem.setdefault(_stem(skeleton), []).append(skeleton)
    found = {motion: _skeleton_of(motion, by_folder, by_stem) for motion in motions}
    return {motion: skeleton for motion, skeleton in found.items() if skeleton is not None}


def _skeleton_of(
    motion: str, by_folder: dict[str, list[str]], by_stem: dict[str, list[str]]
) -> str | None:
    beside = by_folder.get(_folder(motion), [])
    stems = _beginnings(_stem(motion))
    for stem in stems:
        named = [skeleton for skeleton in beside if _stem(skeleton) == stem]
        if named:
            return named[0]
    if len(beside) == 1:
        return beside[0]
    for stem in stems:
        if stem in by_stem:
            return _nearest(motion, by_stem[stem])
    return None


def _beginnings(stem: str) -> list[str]:
    """The stem, and what is left of it where words at its end are cut off, longest first."""
    cuts = [i for i in range(len(stem) - 1, 0, -1) if not stem[i].isalnum()]
    return [stem] + [stem[:cut] for cut in cuts]


def _nearest(motion: str, skeletons: list[str]) -> str | None:
    """The skeleton that shares most folders with the motion; None where several do."""
    folders = PurePosixPath(motion).parent.parts

    def shared(skeleton: str) -> int:
        others = PurePosixPath(skeleton).parent.parts
        pairs = zip(folders, others, strict=False)
        return next((i for i, (a, b) in enumerate(pairs) if a != b), min(len(folders), len(others)))

    most = max(map(shared, skeletons))
    nearest = [skeleton for skeleton in skeletons if shared(skeleton) == most]
    return nearest[0] if len(nearest) == 1 else None


def _folder(path: str) -> str:
    return str(PurePosixPath(path).parent)


def _stem(path: str) -> str:
    return PurePosixPath(path).stem.lower()
