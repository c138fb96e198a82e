"""Names of joints as labels of markers, in formats that take few characters."""

from __future__ import annotations

import re
from collections.abc import Sequence

MAX_LABEL_LENGTH = 40
"""Characters. Programs that read C3D files show no more."""

_OTHER = re.compile(r"[^A-Za-z0-9_.:\-]+")


def marker_labels(names: Sequence[str]) -> list[str]:
    """A label of plain characters without spaces for each name; no two are equal.

    A label that is taken gets a number: `Hips`, `Hips_2`. Case does not make a difference.
    """
    taken: set[str] = set()
    labels = []
    for name in names:
        plain = _OTHER.sub("_", name).strip("_")[:MAX_LABEL_LENGTH] or "joint"
        label, number = plain, 1
        while label.lower() in taken:
            number += 1
            ending = f"_{number}"
            label = plain[: MAX_LABEL_LENGTH - len(ending)] + ending
        taken.add(label.lower())
        labels.append(label)
    return labels
