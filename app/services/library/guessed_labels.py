"""What a recognizer took its clips for while they were held out, stored with the model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from app.models.held_out.recognition import Guess
from app.services.library.precomputed_rows import IDS, id_rows
from app.store import models

Factor = Literal["person", "task"]
FACTORS: tuple[Factor, ...] = ("person", "task")
GUESSES = f"{models.CLIP_ARRAY_PREFIX}guesses"
NAMES = "guessed"
"""Member of the model's metadata: the names that the numbers of GUESSES stand for, by factor."""
NO_NAME = -1

Labels = Sequence[str | None]


def guess_arrays(
    ids: Sequence[str], persons: Labels, tasks: Labels, guesses: Sequence[Guess]
) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    """The arrays and the metadata to store with a recognizer; empty without guesses.

    GUESSES is (N, 4): the person, the guessed person, the task and the guessed task of each clip,
    as indexes of names.
    """
    if not guesses:
        return {}, {}
    columns: list[list[int]] = []
    names: dict[str, list[str]] = {}
    for place, (factor, labels) in enumerate(zip(FACTORS, (persons, tasks), strict=True)):
        guessed = [guess[place] for guess in guesses]
        names[factor] = sorted({name for name in (*labels, *guessed) if name})
        index = {name: number for number, name in enumerate(names[factor])}
        columns.extend(
            [index[name] if name else NO_NAME for name in values] for values in (labels, guessed)
        )
    return {IDS: id_rows(ids), GUESSES: np.array(columns, dtype=np.int32).T}, {NAMES: names}
