"""A fit in a process of its own: what that process runs. Light to import."""

from __future__ import annotations

from typing import Any

from app.config import Settings


def fit_in_child(settings: Settings) -> dict[str, Any]:
    """Open the library's store and fit; returns the job's result."""
    from app.services.training.fit import fit_library
    from app.store.store import Store

    store = Store.open(settings.database, settings.files_dir)
    try:
        return fit_library(store, wordnet=settings.wordnet, persons=settings.recognize_persons)
    finally:
        store.close()
