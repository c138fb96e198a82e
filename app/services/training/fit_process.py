"""The entry point of a fit in a child process. It must be fast to import."""

from __future__ import annotations

from typing import Any

from app.config import Settings


def fit_in_child(settings: Settings) -> dict[str, Any]:
    """Open the library's store and fit its models; returns the result of the job."""
    from app.services.training.fit import fit_library
    from app.store.store import Store

    store = Store.open(settings.database, settings.files_place)
    try:
        return fit_library(store, wordnet=settings.wordnet, persons=settings.recognize_persons)
    finally:
        store.close()
