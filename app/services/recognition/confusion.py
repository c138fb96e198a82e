"""What the default recognizer takes clips for that it has not seen: its confusions at the fit."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.errors import ModelNotFitted
from app.services.library.fitted_models import ModelKind
from app.services.library.guessed_labels import FACTORS, GUESSES, NAMES, NO_NAME, Factor
from app.services.library.library import Library
from app.services.library.missing_model import missing_model, outdated_model
from app.services.library.precomputed_rows import IDS, ids_of
from app.store import models
from app.store.clips import repository as clips
from app.store.clips.record import ClipRecord
from app.store.database.engine import Tx


@dataclass(frozen=True, slots=True)
class Cell:
    """How many clips with a label were taken for `guess`."""

    label: str
    guess: str
    count: int


def confusion(lib: Library, factor: Factor) -> tuple[Sequence[str], list[Cell]]:
    """The names of a factor, and the cells of the confusion matrix that hold clips.

    Raises ModelNotFitted.
    """
    with lib.store.read() as tx:
        names, pairs, _ = _stored(tx, factor)
    counts = Counter(map(tuple, pairs[(pairs != NO_NAME).all(axis=1)].tolist()))
    cells = [Cell(names[own], names[taken], count) for (own, taken), count in counts.items()]
    return names, sorted(cells, key=lambda cell: (cell.label, cell.guess))


def confused_clips(
    lib: Library, factor: Factor, label: str, guess: str, limit: int
) -> tuple[ClipRecord, ...]:
    """The clips with a label that were taken for `guess`, at most `limit`; deleted ones are left
    out. Raises ModelNotFitted.
    """
    with lib.store.read() as tx:
        names, pairs, stored = _stored(tx, factor)
        if label not in names or guess not in names:
            return ()
        cell = [names.index(label), names.index(guess)]
        rows = np.flatnonzero((pairs == cell).all(axis=1))[:limit]
        return tuple(clips.get_many(tx, ids_of(stored[IDS][rows])).values())


def _stored(tx: Tx, factor: Factor) -> tuple[list[str], NDArray[Any], Mapping[str, NDArray[Any]]]:
    """The names, the (N, 2) label and guess of each clip, and all stored arrays."""
    kind = ModelKind.RECOGNIZER.value
    try:
        record = models.current(tx, kind)
    except ModelNotFitted:
        raise missing_model(tx, kind) from None
    stored = models.load_arrays(tx, record.id, (IDS, GUESSES))
    if GUESSES not in stored:
        raise outdated_model(tx, kind)
    names: list[str] = record.meta["model"][NAMES][factor]
    first = 2 * FACTORS.index(factor)
    return names, stored[GUESSES][:, first : first + 2], stored
