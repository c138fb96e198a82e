"""CPU seconds and memory of the fit of each model, on the real clips and on 10,000 clips.

Run: OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 pytest -m bench -s tests/bench/test_fit_speed.py
The large library is disturbed copies of the real clips. The time of a matrix product is printed
too: on a loaded machine, both grow alike.
"""

from __future__ import annotations

import resource
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.errors import NotEnoughLabels
from app.services.library.fitted_models import ModelKind
from app.services.training import fit
from app.services.training.training_set import read_training_set
from app.store.database import schema
from app.store.store import Store
from tests.bench.fitted_library import fill_for_fits
from tests.bench.page import Section

FIGURES = Section(
    "fit_speed",
    "Fits",
    trials="one fit of each model for each size of the library",
)

pytestmark = pytest.mark.bench

LARGE = 10_000
MAX_SECONDS = 60.0
"""CPU seconds of all fits of the large library (issue 19)."""
PRODUCT = 1000
"""Rows and columns of the matrices of the product that tells how fast the machine is now."""


def test_fits(tmp_path: Path) -> None:
    FIGURES.print(f"\n{'CPU seconds':16}, and the peak memory of the process so far", end="")
    large: dict[str, float] = {}
    for count in (500, LARGE):
        large = _fits(_store(tmp_path / str(count), count))
        shown = ", ".join(f"{name} {seconds:.1f}" for name, seconds in large.items())
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        FIGURES.print(
            f"\n{count:6} clips: {sum(large.values()):.1f} ({shown}); {memory:.0f} MB", end=""
        )
    matrix = np.ones((PRODUCT, PRODUCT))
    FIGURES.print(
        f"\nproduct of two matrices of {PRODUCT}: {_seconds(lambda: matrix @ matrix):.2f}"
    )
    assert sum(large.values()) <= MAX_SECONDS


def _store(folder: Path, count: int) -> Store:
    folder.mkdir()
    url = f"sqlite:///{folder / 'library.db'}"
    schema.upgrade(url)
    store = Store.open(url, folder / "files")
    fill_for_fits(store, count)
    return store


def _fits(store: Store) -> dict[str, float]:
    """CPU seconds of reading the training set, and of the fit of each model."""
    found: list[Any] = []
    took = {"reading": _seconds(lambda: found.append(read_training_set(store)))}
    for kind in ModelKind:
        before = fit.Before({}, {}, False, store)
        try:
            took[kind.value] = _seconds(lambda: fit._FITS[kind](found[0], before))  # noqa: B023
        except NotEnoughLabels:
            continue  # nobody annotated keyposes
    return took


def _seconds(do: Callable[[], Any]) -> float:
    began = time.process_time()
    do()
    return time.process_time() - began
