"""Forgetting a person: gait identifies people, so that a library must be able to forget them.

One transaction removes the person's label from every clip, the name from whatever else names the
person (`traces`: names and paths of files, metadata, annotations, lists of imported files), every
evaluation that names the person, and every model that holds persons: after it no search and no
recognition knows the person. A job fits the models again without them; until it is done, whatever
needs those models asks the client to wait. Files keep their content.
"""

from __future__ import annotations

import logging

from app.errors import NotFound
from app.kinedex_error import Place
from app.services import fields
from app.services.clips import traces
from app.services.clips.anonymize import NameRemover
from app.services.library.fitted_models import ModelKind, holds_persons
from app.services.library.library import Library
from app.services.training.models import enqueue_fit
from app.store import audit, evaluations, keyed_calls, models
from app.store.clips import clip_annotations, labels
from app.store.clips import repository as clips
from app.store.database.engine import Tx
from app.store.jobs.record import JobRecord

_log = logging.getLogger(__name__)


def forget_person(lib: Library, name: str) -> JobRecord:
    """Remove a person's labels and all models that hold persons; the job fits the models again.

    A model may still hold a person whose clips were all deleted: this person can be forgotten too.
    Raises BadField, and NotFound if no clip and no model has the person.
    """
    person = fields.text("name", name) or ""
    job = lib.store.write_even_when_full(lambda tx: _forget(tx, person))
    if not lib.store.rebuild():
        _log.warning(
            "unused bytes of the database may still hold the name of a forgotten person:"
            " stop Kinedex and run VACUUM by the program sqlite3"
        )
    lib.store.erase_traces()
    return job


def _forget(tx: Tx, person: str) -> JobRecord:
    known = labels.person_names(tx) | models.person_names(tx) | clip_annotations.person_names(tx)
    if person not in known:
        raise NotFound(
            "No clip carries this person.", places=[Place("name", "is not in the library")]
        )
    of_person = clips.forget_person(tx, person)
    traces.remove_name(tx, person, of_person)
    audit.note(clips=len(of_person))
    models.remove(tx, _HOLDING_PERSONS)
    evaluations.remove_where(tx, NameRemover(person).holds_name)
    keyed_calls.forget_answers(tx)
    return enqueue_fit(tx)


def remove_person_models(lib: Library) -> bool:
    """Remove every model that holds persons, after their recognition was switched off.

    Returns whether there was such a model. Then a fit is queued, for the models without persons.
    """
    with lib.store.write() as tx:
        removed = models.remove(tx, _HOLDING_PERSONS)
        if removed:
            enqueue_fit(tx)
            _log.info("models that hold persons were removed")
    return bool(removed)


_HOLDING_PERSONS = tuple(kind.value for kind in ModelKind if holds_persons(kind))
