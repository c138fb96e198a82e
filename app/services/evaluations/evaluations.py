"""Evaluations as a client uses them: request one, list the kept results, read and delete them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from hashlib import sha256
from typing import Any

from app.errors import Canceled, TooLarge
from app.services.evaluations.options import EvaluationKind, EvaluationOptions, check
from app.services.library.library import Library
from app.store import evaluations as stored
from app.store.clips import labels
from app.store.database.engine import Tx
from app.store.database.paging import Page
from app.store.evaluations import EvaluationRecord, NewEvaluation
from app.store.jobs import leases
from app.store.jobs import repository as jobs
from app.store.jobs.record import ClaimedJob, JobKind, JobRecord, NewJob

PRIORITY = 40
"""An evaluation runs after all analyses and fits."""
MAX_DOCUMENT_BYTES = 4 * 2**20
"""Of a kept document, as JSON."""
LARGE_MEMBERS = ("confusion", "curve", "by_name", "by_group", "categories", "clips")
"""The members that are left out of a document that is too large, in this order."""
TRIMMED = "trimmed"
"""The member that names what was left out."""


@dataclass(frozen=True, slots=True)
class Evaluated:
    """What an evaluation has found. persons: all persons of the library at its start."""

    result: NewEvaluation
    persons: frozenset[str]


def request(lib: Library, kind: EvaluationKind, options: EvaluationOptions) -> JobRecord:
    """Queue an evaluation; returns the queued one with the same options if there is one.

    Raises BadField for options that this kind does not have, and for wrong values.
    """
    check(kind, options)
    payload = {"kind": kind.value, "options": options.to_json()}
    digest = sha256(json.dumps(payload, sort_keys=True).encode()).hexdigest()
    new = NewJob(
        JobKind.EVALUATE, payload=payload, priority=PRIORITY, dedupe_key=f"evaluate {digest}"
    )
    with lib.store.write() as tx:
        return jobs.enqueue(tx, new)


def requested(claimed: ClaimedJob) -> tuple[EvaluationKind, EvaluationOptions]:
    """What an evaluation's job asks for."""
    options = EvaluationOptions.from_json(claimed.payload["options"])
    return EvaluationKind(claimed.payload["kind"]), options


def finish(tx: Tx, claimed: ClaimedJob, found: Evaluated) -> None:
    """Keep the result and end its job. Raises LeaseLost.

    If a person was forgotten meanwhile, nothing is kept: the result may name the person.
    """
    if not found.persons <= labels.person_names(tx):
        reason = "A person was removed from the library during the evaluation: start it again."
        leases.fail(tx, claimed.lease, Canceled(reason).as_problem())
        return
    record = stored.add(tx, found.result)
    leases.succeed(tx, claimed.lease, {"evaluation_id": record.id, "kind": record.kind})


def list_evaluations(
    lib: Library, kind: EvaluationKind | None = None, limit: int = 50, cursor: str | None = None
) -> Page[EvaluationRecord]:
    """One page of results, newest first. Raises PageNotFound for a bad cursor."""
    name = None if kind is None else kind.value
    with lib.store.read() as tx:
        page = stored.list_page(tx, kind=name, limit=limit, cursor=cursor)
        return page.counted(stored.total(tx, kind=name))


def get_evaluation(
    lib: Library, evaluation_id: str
) -> tuple[EvaluationRecord, dict[str, Any], EvaluationRecord | None]:
    """A result, its document, and the result of the same kind before it.

    Raises EvaluationNotFound.
    """
    with lib.store.read() as tx:
        record = stored.get(tx, evaluation_id)
        return record, stored.document(tx, evaluation_id), stored.before(tx, record)


def delete_evaluation(lib: Library, evaluation_id: str) -> None:
    """Delete a result. Raises EvaluationNotFound."""
    lib.store.write_even_when_full(lambda tx: stored.remove(tx, evaluation_id))


def bounded(document: dict[str, Any], most: int = MAX_DOCUMENT_BYTES) -> dict[str, Any]:
    """The document, without its large members if it has more than `most` bytes as JSON.

    `trimmed` then names them. Raises TooLarge if the rest is still too large.
    """
    trimmed: list[str] = []
    left = iter(LARGE_MEMBERS)
    while (size := len(json.dumps(document))) > most:
        member = next(left, None)
        if member is None:
            raise TooLarge(
                f"The results have {size} bytes; at most {most} are kept. Judge fewer clips, by a "
                "filter."
            )
        trimmed.append(member)
        document = _without(document, member) | {TRIMMED: list(trimmed)}
    return document


def _without(value: Any, member: str) -> Any:
    """JSON without the members of this name."""
    if isinstance(value, dict):
        return {name: _without(one, member) for name, one in value.items() if name != member}
    return [_without(one, member) for one in value] if isinstance(value, list) else value
