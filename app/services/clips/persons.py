"""Forgetting a person: gait identifies people, so that a library must be able to forget them.

One transaction removes the person's label from every clip, and every model that holds persons:
after it no search and no recognition knows the person. A job fits the models again without them;
until it is done, whatever needs those models asks the client to wait. Files keep their content and
their names.
"""

from __future__ import annotations

import logging

from app.errors import NotFound, Place
from app.services import fields
from app.services.library.fitted_models import ModelKind, holds_persons
from app.services.library.library import Library
from app.services.training.models import enqueue_fit
from app.store import keyed_calls, models
from app.store.clips import labels
from app.store.clips import repository as clips
from app.store.database.engine import Tx
from app.store.jobs.record import JobRecord

_log = logging.getLogger(__name__)


def forget_person(lib: Library, name: str) -> JobRecord:
    """Remove a person's labels and every model that holds them; the job fits the models anew.

    A person whose clips were all deleted may still be held by a model; they can be forgotten too.
    Raises NotFound where no clip carries the person and no model holds them, BadField.
    """
    person = fields.text("name", name) or ""
    job = lib.store.write_even_when_full(lambda tx: _forget(tx, person))
    lib.store.erase_traces()
    return job


def _forget(tx: Tx, person: str) -> JobRecord:
    if person not in labels.person_names(tx) | models.person_names(tx):
        raise NotFound(
            "No clip carries this person.", places=[Place("name", "is not in the library")]
        )
    clips.forget_person(tx, person)
    models.remove(tx, _HOLDING_PERSONS)
    keyed_calls.forget_answers(tx)
    return enqueue_fit(tx)


def remove_person_models(lib: Library) -> bool:
    """Remove every model that holds persons, as when their recognition is switched off.

    Returns whether there was one; then a fit is queued, for what can be had without persons.
    """
    with lib.store.write() as tx:
        removed = models.remove(tx, _HOLDING_PERSONS)
        if removed:
            enqueue_fit(tx)
            _log.info("models that hold persons were removed")
    return bool(removed)


_HOLDING_PERSONS = tuple(kind.value for kind in ModelKind if holds_persons(kind))
