"""The client's calls and types are those of the OpenAPI description."""

from __future__ import annotations

import inspect
from typing import Any

import pytest

from kinedex import Kinedex
from kinedex.methods import Group
from tests.client.generator.files import CLIENT, description, generated
from tests.client.generator.names import method_name
from tests.client.generator.operations import Operation, operations

FOLLOWED = {"follow_job"}
"""Operations whose methods are written by hand: server-sent events."""
OPERATIONS = [one for one in operations(description()) if one.id not in FOLLOWED]


@pytest.fixture(scope="module")
def offline() -> Kinedex:
    return Kinedex("http://127.0.0.1:1")


@pytest.mark.parametrize("name", sorted(generated()))
def test_each_generated_file_is_up_to_date(name: str) -> None:
    assert (CLIENT / name).read_text() == generated()[name], "run `make client`"


def test_no_other_file_is_among_the_generated_ones() -> None:
    found = {
        f"{folder}/{path.name}"
        for folder in ("calls", "types")
        for path in (CLIENT / folder).glob("[!_]*.py")
    }
    assert found | {"groups.py"} == set(generated())


@pytest.mark.parametrize("one", OPERATIONS, ids=lambda one: one.id)
def test_each_operation_has_one_method_with_its_parameters(
    one: Operation, offline: Kinedex
) -> None:
    method = _method(offline, one)
    parameters = inspect.signature(method).parameters
    expected = {parameter.name for parameter in one.parameters}
    assert set(parameters) - {"progress"} == expected
    needed = {p.name for p in parameters.values() if p.default is inspect.Parameter.empty}
    assert needed == {parameter.name for parameter in one.parameters if parameter.is_required}
    assert (inspect.getdoc(method) or "").strip()


def test_jobs_can_be_followed(offline: Kinedex) -> None:
    assert callable(offline.jobs.follow)


def test_operations_of_new_tags_get_a_group_of_their_own() -> None:
    found = method_name("get_gait", "gait-analysis")
    assert (found.group, found.name) == ("gait_analysis", "gait")


def _method(client: Kinedex, one: Operation) -> Any:
    group = getattr(client, one.name.group) if one.name.group else client
    assert isinstance(group, Group)
    return getattr(group, one.name.name)
