"""Each class of failure becomes a problem with the right status."""

from __future__ import annotations

import pytest

from app import errors
from app.api.failures.problems import problem_of, problem_of_validation, status_of, stored_problem
from app.kinedex_error import KinedexError, Place


def _all_kinds(kind: type[KinedexError] = KinedexError) -> list[type[KinedexError]]:
    return [kind, *(deep for child in kind.__subclasses__() for deep in _all_kinds(child))]


@pytest.mark.parametrize("kind", _all_kinds(), ids=lambda kind: kind.__name__)
def test_every_failure_has_a_status_and_all_members(kind: type[KinedexError]) -> None:
    members = problem_of(kind())
    assert list(members) == ["type", "title", "status", "detail", "code", "errors"]
    assert 400 <= members["status"] <= 599


@pytest.mark.parametrize(
    ("kind", "status"),
    [
        (errors.BadField, 422),
        (errors.EmptyFile, 422),
        (errors.Unreadable, 422),
        (errors.UnknownFormat, 415),
        (errors.TooLarge, 413),
        (errors.ClipNotFound, 404),
        (errors.ClipNotReady, 409),
        (errors.ModelNotFitted, 409),
        (errors.Canceled, 409),
        (errors.Unauthorized, 401),
        (errors.Forbidden, 403),
        (errors.DiskFull, 507),
        (errors.DatabaseOutOfDate, 500),
        (errors.ConfigurationError, 500),
    ],
)
def test_the_table_of_statuses(kind: type[KinedexError], status: int) -> None:
    assert status_of(kind) == status


def test_details_of_an_internal_failure_are_hidden() -> None:
    members = problem_of(errors.StorageError("cannot open /secret/place", places=[Place("a", "b")]))
    assert "secret" not in str(members)
    assert members["errors"] == []


def test_a_stored_failure_is_completed_to_a_problem() -> None:
    stored = errors.Unreadable("bad", places=[Place("line 12", "a number")]).as_problem()
    members = stored_problem(stored)
    assert members["status"] == 422
    assert members["type"] == "urn:kinedex:problem:unreadable"
    assert members["errors"] == [{"location": "line 12", "message": "a number"}]


def test_only_a_body_that_is_not_json_is_malformed() -> None:
    whole = {"type": "json_invalid", "loc": ("body", 3), "msg": "x"}
    field = {"type": "json_invalid", "loc": ("body", "filter"), "msg": "x"}
    assert problem_of_validation([whole])["status"] == 400
    assert problem_of_validation([field])["status"] == 422


def test_a_problem_lists_at_most_a_hundred_wrong_fields() -> None:
    found = [{"type": "extra_forbidden", "loc": ("body", str(i)), "msg": "x"} for i in range(1000)]
    assert len(problem_of_validation(found)["errors"]) == 100
