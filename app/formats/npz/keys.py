"""The names of arrays in NPZ files of motion. Arrays are read by our names for them."""

from __future__ import annotations

import re
from typing import Any

from numpy.typing import NDArray

from app.formats.npz.arrays import Archive, numbers

KEYS: dict[str, tuple[str, ...]] = {
    "positions": (
        "positions", "jointpositions", "globalpositions", "joints3d", "keypoints3d", "keypoints",
        "posedjoints", "worldpositions", "points", "joints", "markers", "xyz", "pos", "arr0",
    ),
    "joint_names": (
        "jointnames", "names", "joints", "markers", "bonenames", "markernames", "labels",
        "keypointnames",
    ),
    "parents": ("parents", "jointparents", "parent", "kintreetable", "bonesparents"),
    "frame_rate": (
        "framerate", "fps", "mocapframerate", "mocapfps", "rate", "samplingrate", "frequency",
    ),
    "unit": ("unit", "units", "metresperunit", "metersperunit"),
    "up_axis": ("upaxis", "up"),
    "poses": ("poses", "smplposes", "fullpose"),
    "root_orient": ("rootorient", "globalorient"),
    "pose_body": ("posebody", "bodypose"),
    "trans": ("trans", "transl", "smpltrans", "translation"),
}  # fmt: skip
"""Our name of each array, and its names in files, in lower case and without separators."""
_ALL_NAMES = frozenset(name for names in KEYS.values() for name in names)
AMBIGUOUS = ("joints", "markers")
"""Names of arrays that contain either the names of joints or their positions."""


class NamedArrays:
    """The arrays of an archive by our names."""

    def __init__(self, archive: Archive) -> None:
        """Read the keys, but no numbers. Raises Unreadable."""
        self.keys = archive.keys()
        self._archive = archive
        plain = {_plain(key): key for key in self.keys}
        self._found = {
            name: [plain[key] for key in aliases if key in plain] for name, aliases in KEYS.items()
        }
        for name, kinds in (("joint_names", "US"), ("positions", "fiu")):
            self._found[name] = [key for key in self._found[name] if self._is(key, kinds)]

    def _is(self, key: str, kinds: str) -> bool:
        return _plain(key) not in AMBIGUOUS or self._archive.kind(key) in kinds

    def __contains__(self, name: str) -> bool:
        """Whether the file has the array with our name `name`."""
        return bool(self._found[name])

    def key(self, name: str) -> str:
        """The name of an array in the file; our name if the file does not have it."""
        return self._found[name][0] if name in self else name

    def read(self, name: str) -> NDArray[Any] | None:
        """The array with our name `name`; None if there is none. Raises Unreadable, TooLarge."""
        return self._archive.read(self.key(name)) if name in self else None

    def numbers(self, name: str) -> NDArray[Any] | None:
        """As `read`, but raises Unreadable also for an array of anything but numbers."""
        array = self.read(name)
        return None if array is None else numbers(array, self.key(name))


def is_known_array(key: str) -> bool:
    """Whether `key` is one of the names in KEYS, in any case and with any separators."""
    return _plain(key) in _ALL_NAMES


def _plain(key: str) -> str:
    return re.sub(r"[^a-z0-9]", "", key.lower())
