"""Plans a synthesis: which clips of the person and of others it uses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from app.errors import ClipNotReady, NotEnoughLabels, NotFound
from app.kinedex_error import Place
from app.models.synthesis.agreement import agree
from app.models.synthesis.model import Synthesis, mean_of_takes
from app.models.synthesis.prediction import Predicted, predict
from app.numerics.arrays import FloatArray
from app.search.index import usable_arrays
from app.services import fields
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clips
from app.services.training.synthesis_fit import SHAPE
from app.store.clips.record import ClipRecord


class SynthesisKind(StrEnum):
    """The kind of a synthesis."""

    NEW_TASK = "new_task"
    """A task that a known person never recorded."""
    NEW_PERSON = "new_person"
    """A task by the person of some clips."""
    SEEN = "seen"
    """A recorded task: the mean of the person's takes, or one take if they do not agree."""


@dataclass(frozen=True, slots=True)
class Plan:
    """The plan of a synthesis.

    shape: (1378,) the predicted motion shape; person: None if the clips have no person; own: ids
    of real clips of the person, for their skeleton; given_tasks: tasks of the person;
    given_persons: persons who did the task; takes: ids of real clips of the task by them;
    follows: the person whose take is followed if the takes do not agree (see `MIN_AGREEMENT`); then
    `takes` are of that person; agreement: of the takes, None for a single take.
    """

    kind: SynthesisKind
    person: str | None
    task: str
    shape: FloatArray
    own: tuple[str, ...]
    given_tasks: tuple[str, ...]
    given_persons: tuple[str, ...]
    takes: tuple[str, ...]
    follows: str | None
    agreement: float | None


def plan_of(
    lib: Library,
    model: Synthesis,
    task: str,
    person: str | None,
    clip_ids: tuple[str, ...] | None,
) -> Plan:
    """The plan for a query. Raises the errors of `synthesize`."""
    if task not in model.tasks:
        raise _unknown("task", task, model.tasks)
    if clip_ids is not None:
        return _of_clips(lib, model, task, clip_ids)
    if person not in model.persons:
        raise _unknown("person", person or "", model.persons)
    return _of_person(model, task, person)


def _of_person(model: Synthesis, task: str, person: str) -> Plan:
    own = tuple(model.ids[i] for i in model.clips_of(person))
    given = model.tasks_of(person)
    seen = model.cell(person, task)
    if seen is not None:
        agreement = model.cell_agreement(person, task)
        follows = None if agree(agreement) else person
        found = Predicted(seen, follows, agreement)
        return _plan(model, SynthesisKind.SEEN, person, task, found, own, given, (person,))
    found, others = predict(model, given, task), model.who_did(task)
    return _plan(model, SynthesisKind.NEW_TASK, person, task, found, own, given, others)


def _of_clips(lib: Library, model: Synthesis, task: str, clip_ids: tuple[str, ...]) -> Plan:
    """A plan from these clips alone, as if the library had no other clip of the person."""
    by_id = ready_clips(lib, clip_ids, "clip_ids")
    found, own = list(by_id.values()), tuple(by_id)
    person = _person_of(found)
    given = _by_task(lib, model, found, task)
    predicted = predict(model, given, task, exclude=(person,) if person else ())
    others = tuple(name for name in model.who_did(task) if name != person)
    return _plan(model, SynthesisKind.NEW_PERSON, person, task, predicted, own, given, others)


def _plan(
    model: Synthesis,
    kind: SynthesisKind,
    person: str | None,
    task: str,
    predicted: Predicted,
    own: tuple[str, ...],
    given: Mapping[str, FloatArray],
    persons: tuple[str, ...],
) -> Plan:
    """The plan for a prediction; persons: those who did the task."""
    followed = persons if predicted.follows is None else (predicted.follows,)
    takes = [model.ids[i] for name in followed for i in model.clips_of(name, task)]
    return Plan(
        kind,
        person,
        task,
        predicted.shape,
        own,
        tuple(given),
        persons,
        tuple(takes),
        predicted.follows,
        predicted.agreement,
    )


def _person_of(found: list[ClipRecord]) -> str | None:
    """The person of the clips, None if they have none. Raises BadField for several persons."""
    persons = sorted({clip.person for clip in found if clip.person})
    if len(persons) > 1:
        raise fields.bad_field("clip_ids", f"must be of one person, not of {', '.join(persons)}")
    return persons[0] if persons else None


def _by_task(
    lib: Library, model: Synthesis, found: list[ClipRecord], task: str
) -> dict[str, FloatArray]:
    """(1378,) mean shapes of the clips by task, without the task to synthesize."""
    with lib.store.read() as tx:
        shapes = usable_arrays.get_many(tx, [clip.id for clip in found], SHAPE)
    by_task: dict[str, list[FloatArray]] = {}
    for clip in found:
        if clip.id not in shapes:
            raise ClipNotReady(
                "The clip was analyzed by an older Kinedex: run `kinedex reanalyze`.",
                places=[Place("clip_ids", f"{clip.id} was analyzed by an older Kinedex")],
            )
        if clip.task in model.tasks and clip.task != task:
            by_task.setdefault(clip.task or "", []).append(shapes[clip.id])
    if not by_task:
        known = ", ".join(name for name in model.tasks if name != task)
        message = f"at least one must be labeled with another task of the library: {known}"
        raise NotEnoughLabels(
            f"Nothing can be learned from these clips: {message}.",
            places=[Place("clip_ids", message)],
        )
    return {name: mean_of_takes(np.stack(rows)) for name, rows in by_task.items()}


def _unknown(field: str, name: str, known: tuple[str, ...]) -> NotFound:
    shown = ", ".join(known[:20]) + (", ..." if len(known) > 20 else "")
    return NotFound(
        f"No model knows the {field} {name!r}. Known: {shown}. Clips that were added or labeled"
        " later count after the next fit of the models.",
        places=[Place(field, f"must be one of: {shown}")],
    )
