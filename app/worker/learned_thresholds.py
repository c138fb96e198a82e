"""Analyzes clips again when a fit has learned other thresholds of keyposes."""

from __future__ import annotations

from app.services.clips import reanalysis
from app.services.library.fitted_models import ModelKind
from app.services.library.library import Library
from app.store import models


class LearnedThresholds:
    """Notices a new model of keyposes."""

    def __init__(self, lib: Library) -> None:
        self._lib = lib
        # id and settings of the model at the last look
        self._seen: object = None

    def requeue_if_changed(self) -> bool:
        """Queue the clips whose keyposes have other thresholds; returns whether there are any.

        The caller must run no analysis: one that began before the fit used the old thresholds.
        """
        with self._lib.store.read() as tx:
            current = models.current_ids(tx).get(ModelKind.KEYPOSES.value)
        if current == self._seen:
            return False
        queued = reanalysis.requeue_outdated(self._lib)
        self._seen = current
        return queued > 0
